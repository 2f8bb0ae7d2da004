"""What ``placecue info`` finds: gaps, coverage, the way of the robot."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import IndexType

from mcap_logs import SECOND, START
from placecue.evaluation.thumbnail import thumbnail
from placecue.logs.info import summarise
from placecue.logs.joining.timing import Gap, largest_gaps
from placecue.logs.mcap.container import LogFile
from placecue.logs.reader import McapLog
from placecue.logs.writing.trail import Trail
from placecue.observation import Observation, Pose2D


@pytest.mark.parametrize("options", [{}, {"use_chunking": False}, {"index_types": IndexType.NONE}])
def test_the_largest_gap_of_each_topic(as_json: Any, options: dict[str, Any]) -> None:
    log = as_json(**options)
    for t in [0.0, 1.0, 1.5, 4.5, 4.0, 5.0]:
        log.scan(t, [1.0])
    log.put("/once", "a", {}, 0.0)
    file = LogFile(log.close())
    assert largest_gaps(file, file.topics()) == {"/scan": Gap(2.5, START + 3 * SECOND // 2)} or (
        # A file without an index is taken in its own order.
        largest_gaps(file, file.topics()) == {"/scan": Gap(3.0, START + 3 * SECOND // 2)}
    )


def test_coverage_and_trail(ros2: Any) -> None:
    log = ros2()
    for i in range(8):
        if i == 2:
            log.string(0.2, "hall")
        log.odom(i * 0.1, float(i), -1.0, 0.0)
        log.scan(i * 0.1, [1.0])
    opened = McapLog(log.close())
    summary = summarise(opened)
    assert summary.coverage == pytest.approx(6 / 8)
    assert list(summary.trail) == [(float(i), -1.0, "hall" if i > 1 else "") for i in range(8)]
    other = summarise(opened, lambda moment: "east" if moment.pose and moment.pose.x > 4 else None)
    assert dict(other.labels) == {"": 5, "east": 3}


def test_a_long_way_is_thinned() -> None:
    trail = Trail(most=100)
    for i in range(10_000):
        trail.add(Observation(i, pose=Pose2D(float(i), 0.0, 0.0)))
    trail.add(Observation(0))
    xs = [x for x, _, _ in trail.points]
    assert 50 <= len(xs) <= 100
    steps = {b - a for a, b in pairwise(xs)}
    assert len(steps) == 1
    assert xs[0] == 0.0
    assert 10_000 - xs[-1] <= 2 * steps.pop()


def test_a_thumbnail() -> None:
    """An L of dots: down the left side and along the bottom."""
    trail = [(0.0, float(y), "up") for y in range(8)] + [(float(x), 0.0, "right") for x in range(4)]
    picture = thumbnail(trail, {"up": "#ff0000", "right": "#0000ff"}, columns=4, rows=2)
    # A character is two dots wide and four high, the left column of dots is 1, 2, 4, 64.
    lower_left = 1 + 2 + 4 + 64 + 128
    assert picture.plain.split("\n") == [
        chr(0x2800 + 1 + 2 + 4 + 64),
        chr(0x2800 + lower_left) + chr(0x2800 + 64 + 128),
    ]
    assert str(picture.spans[0].style) == "#ff0000"
    assert thumbnail(trail, {}, columns=4, rows=2, plain=True).plain == "*\n**"
    assert thumbnail([], {}).plain == ""
    assert thumbnail([(1.0, 1.0, "a"), (float("nan"), 0.0, "a")], {}).plain.count("\n") == 0


def test_a_damaged_log_is_said_to_be_one(ros2: Any, tmp_path: Path) -> None:
    log = ros2(chunk_size=500)
    for i in range(20):
        log.scan(i * 0.1, [1.0])
    path = Path(log.close())
    path.write_bytes(path.read_bytes()[:-300])
    summary = summarise(McapLog(str(path)))
    assert not summary.whole
    assert summary.observations == 20
