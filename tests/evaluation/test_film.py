"""Stills of a growing map: how many, when, and side by side."""

import cv2
import numpy as np
import pytest

from placecue import Area, Node, Observation, Pose2D, SemanticMap
from placecue.evaluation.film import Film, draw_film
from placecue.evaluation.map_styles import category_styles, shade
from placecue.free_space import FreeSpace

CLASSES = ("kitchen", "office")


class Follower:
    """A map of the way so far: kitchen to x = 10, office beyond."""

    def __init__(self):
        self.way = []

    def semantic_map(self):
        parts = {
            "kitchen": [p for p in self.way if p[0] < 10],
            "office": [p for p in self.way if p[0] >= 10],
        }
        named = [(name, way) for name, way in parts.items() if way]
        areas = tuple(Area(i, n, 1.0, trajectory=tuple(w)) for i, (n, w) in enumerate(named))
        return SemanticMap(
            areas, tuple(Node(i, *a.trajectory[0], i) for i, a in enumerate(areas)), (), CLASSES
        )


def filmed(count, length):
    follower, space = Follower(), FreeSpace()
    film = Film(count, follower, space)
    for i in range(length):
        pose = Pose2D(20 * i / length, 0.0, 0.0)
        follower.way.append((pose.x, pose.y))
        seen = Observation(i * 10**9, pose=pose)
        space.observe(seen)
        film.observe(seen, None, None)
    return film


@pytest.mark.parametrize("length", [30, 50, 333])
def test_stills_are_spread_over_the_drive_and_few_are_held(length):
    film = filmed(6, length)
    assert len(film._stills) <= 12
    times = [still.seconds for still in film.stills()]
    assert times[-1] == pytest.approx(length - 1)
    assert len(times) == 6
    np.testing.assert_allclose(np.diff([0, *times]), length / 6, atol=length / 8 + 1)


def test_a_still_shows_what_was_known_then(tmp_path):
    early, _, late = filmed(3, 60).stills()
    assert [area.label for area in early.semantic_map.areas] == ["kitchen"]
    assert [area.label for area in late.semantic_map.areas] == ["kitchen", "office"]
    assert early.grid.states.shape[1] < late.grid.states.shape[1]
    np.testing.assert_allclose(early.way[-1], [20 * early.seconds / 60, 0])
    picture = cv2.imread(str(draw_film([early, late], tmp_path / "film.png", CLASSES)))
    office = shade(category_styles(CLASSES)["office"][0], 1.0)
    found = (picture[..., ::-1] == [int(office[i : i + 2], 16) for i in (1, 3, 5)]).all(axis=2)
    assert found.any()
    assert not found[:, : picture.shape[1] // 2][: picture.shape[0] // 3].any()


def test_nothing_gives_no_stills():
    assert Film(3, Follower(), FreeSpace()).stills() == []
