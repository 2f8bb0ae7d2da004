"""The page that shows a map growing: what it serves, to whom, and what a browser makes of it."""

from __future__ import annotations

import http.client
import json
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from browser import FLAGS, browser
from placecue import AreaUpdate, Belief, Observation, Pose2D, Scores
from placecue.free_space import FREE, OCCUPIED, UNSEEN, Grid
from placecue.scores import Probabilities
from placecue.semantic_map import Area, Node, SemanticMap
from placecue.serving.onlooker import Moment
from placecue.serving.page import Page

CLASSES = ("corridor", "kitchen", "</script><b>lab")
PLACES = Probabilities(CLASSES)


def probabilities(*values: float) -> Scores:
    return Scores(np.array([values]), PLACES)


def belief() -> Belief:
    said = {"laser": probabilities(0.3, 0.6, 0.1), "camera": probabilities(0.05, 0.85, 0.1)}
    return Belief(7, probabilities(0.1, 0.8, 0.1), "kitchen", 0.7, said, ("depth",))


def semantic_map() -> SemanticMap:
    square = (((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)),)
    area = Area(2, "kitchen", 0.93, trajectory=((1.0, 1.0), (2.0, 1.0)), surface=(square,))
    return SemanticMap((area,), (Node(0, 1.0, 1.0, 2),), (), CLASSES)


def grid() -> Grid:
    states = np.full((5, 6), UNSEEN)
    states[:4, :5] = FREE
    states[0] = OCCUPIED
    return Grid(states, 1.0, -0.5, -0.5, "odom")


@pytest.fixture
def page() -> Iterator[Page]:
    found = Page("robot </script>", CLASSES, port=0, more=lambda: {"dropped": "3"})
    yield found
    found.close()


def shows(page: Page) -> None:
    seen = Observation(7, pose=Pose2D(1.0, 1.0, 0.5))
    page.moment(Moment(seen, belief(), AreaUpdate(2, "kitchen", 0.93)))
    page.map(7, semantic_map(), grid())


def get(page: Page, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    port = int(re.findall(r":(\d+)/", page.url)[0])
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    return answer.status, dict(answer.getheaders()), answer.read()


def state(page: Page, path: str = "/state") -> Any:
    return json.loads(get(page, path)[2])


def test_the_state(page: Page) -> None:
    assert state(page) == {"version": 0, "ended": False, "more": {"dropped": "3"}}
    shows(page)
    told = state(page)
    assert told["pose"] == [1.0, 1.0, 0.5]
    assert told["area"] == {"id": 2, "label": "kitchen", "confidence": 0.93}
    # Probabilities stay what they are.
    assert told["belief"]["confidence"] == pytest.approx(0.8)
    assert told["belief"]["cues"]["camera"] == {"label": "kitchen", "confidence": 0.85}
    assert told["belief"]["missing"] == ["depth"]
    assert told["map"]["areas"][0]["surface"] == [[[[0, 0], [4, 0], [4, 3], [0, 3]]]]
    assert "map" not in state(page, "/state?map=1")
    assert "map" in state(page, "/state?map=nonsense")
    page.end()
    assert state(page)["ended"]


def test_free_space_is_a_picture(page: Page) -> None:
    import base64

    shows(page)
    space = state(page)["map"]["space"]
    data = np.frombuffer(base64.b64decode(space["png"]), np.uint8)
    picture = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE)
    # Upside up: the wall of the lowest row is the last one of the picture.
    assert picture[-1].tolist() == [255] * 6
    assert picture[-2].tolist() == [0] * 5 + [128]
    assert (space["x"], space["y"], space["cell"]) == (-0.5, -0.5, 1.0)


def test_only_this_machine_is_answered(page: Page) -> None:
    """A page of somebody else's, whose name leads here, must not read what the robot sees."""
    assert get(page, "/state", Host="evil.example")[0] == 403
    assert get(page, "/state", Host="localhost:80")[0] == 200
    assert get(page, "/other")[0] == 404
    _, headers, content = get(page, "/")
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    # Whatever things are called, there is the one script.
    assert content.count(b"</script>") == 1


def test_in_a_browser(page: Page, tmp_path: Path) -> None:
    """Room, cues and map are shown; nothing is complained of, and nothing asked from elsewhere."""
    shows(page)
    picture = tmp_path / "shown.png"
    flags = [each for each in FLAGS if not each.startswith("--host-resolver")]
    done = subprocess.run(
        [browser(), *flags, "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
         f"--user-data-dir={tmp_path / 'profile'}", f"--screenshot={picture}", "--dump-dom",
         page.url],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    assert [line for line in done.stderr.splitlines() if "CONSOLE" in line] == []
    shown = re.sub(r"<script>.*?</script>|<style>.*?</style>", "", done.stdout, flags=re.DOTALL)
    text = " ".join(re.sub(r"<[^>]*>", " ", shown).split())
    assert "Room kitchen area 2, 93 % sure" in text
    assert "all cues kitchen 80 %" in text
    assert "laser kitchen 60 %" in text
    assert "camera kitchen 85 %" in text
    assert "missing: depth" in text
    assert "dropped 3" in text
    # The kitchen is filled in its colour, the second of the palette.
    blue, green, red = cv2.split(cv2.imread(str(picture)).astype(int))
    assert ((blue > red + 60) & (green > red + 20)).mean() > 0.1
