"""Freiburg 079, recorded by C. Stachniss: 422 m through an office floor, with its doors."""

import os
from pathlib import Path

import numpy as np
import pytest

from placecue_accumulators.door import Door
from placecue_accumulators.spatiotemporal import SpatioTemporal
from placecue_sources.carmen import CarmenLog

#: Middles of doorways that the robot passes, read off the drawn laser end points, m.
DOORWAYS = [
    (-6.5, 0.1), (-10.4, 1.9), (-19.7, -0.4), (-23.4, 0.5), (-15.2, -0.4), (-10.7, -0.9),
    (-0.7, 1.1), (0.6, -1.7), (7.7, 0.4), (-13.6, 3.9), (10.4, 1.9), (10.1, -1.2),
]  # fmt: skip


@pytest.fixture(scope="module")
def observations():
    if "PLACECUE_DATA" not in os.environ:
        pytest.skip("PLACECUE_DATA is not set: no real laser log")
    path = Path(os.environ["PLACECUE_DATA"]) / "carmen" / "freiburg-079-corrected.log.gz"
    return list(CarmenLog(path=str(path)))


def passed(door, observations):
    return [(p.x, p.y) for o in observations if (p := door.update(o)) is not None]


def near(found):
    apart = np.linalg.norm(np.array(found)[:, None] - np.array(DOORWAYS)[None], axis=2)
    return apart.min(axis=0) < 0.5


def test_the_group_s_numbers_find_some_doors(observations):
    found = passed(Door(), observations)
    assert 15 <= len(found) <= 25
    assert near(found).sum() >= 5


def test_a_wider_gap_finds_the_doors_in_spite_of_noise(observations):
    found = passed(Door(max_gap=0.05, post_bearing=30), observations)
    assert near(found).all()
    assert len(found) <= 60


def test_the_floor_is_cut_into_rooms(observations):
    accumulator = SpatioTemporal(Door(max_gap=0.05, post_bearing=30), gateway_spacing=1.0)
    for observation in observations:
        accumulator.update(observation, None)
    made = accumulator.semantic_map()
    assert 15 <= len(made.areas) <= 30
    assert made.frame == "map"
