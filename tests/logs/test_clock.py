"""Clocks that jump, stamps that repeat or come late: the reading goes on, and says so once."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mcap_logs import SECOND, START
from placecue.logs import open_log
from placecue.logs.joining.items import Item
from placecue.logs.joining.synchronise import Synchroniser

WINDOW = 400


def stamps(times: list[int], followers: list[tuple[int, int]] = ()) -> tuple[list[int], Any]:  # type: ignore[assignment]
    """Join drivers, with scans that come before the driver of the given number."""
    kinds: list[Any] = ["scan"] if followers else []
    joined = Synchroniser("image", kinds, 50, WINDOW, 10_000)
    found = []
    for number, time in enumerate(times):
        for at, stamp in followers:
            if at == number:
                found += list(joined.push(Item(stamp, "scan", lambda: None)))
        found += list(joined.push(Item(time, "image", lambda: None)))
    found += list(joined.finish())
    return [match.driver.stamp for match in found], joined


def test_observations_go_on_where_the_clock_jumps_back() -> None:
    times = [*range(5000, 6000, 100), *range(1000, 3000, 100)]
    found, joined = stamps(times)
    assert found == times
    assert (joined.jumps, joined.late) == (1, 0)


def test_one_stamp_far_ahead_costs_nothing_else() -> None:
    times = [100, 200, 300, 9_000_000, 400, 500, 600]
    found, joined = stamps(times)
    assert sorted(found) == sorted(times)
    assert (joined.jumps, joined.late) == (1, 0)


def test_one_stamp_far_back_is_left_out() -> None:
    found, joined = stamps([1000, 1100, 5, 1200, 1300])
    assert found == [1000, 1100, 1200, 1300]
    assert (joined.jumps, joined.late) == (0, 1)
    assert joined.first == {"late": 5}


def test_a_jump_keeps_scans_of_the_new_time_and_forgets_the_old_ones() -> None:
    times = [*range(5000, 6000, 100), *range(1000, 2000, 100)]
    scans = [(i, time + 10) for i, time in enumerate(times)]
    joined = Synchroniser("image", ["scan"], 50, WINDOW, 10_000)
    matches = []
    for time, (_, scan) in zip(times, scans, strict=True):
        matches += list(joined.push(Item(scan, "scan", lambda: None)))
        matches += list(joined.push(Item(time, "image", lambda: None)))
    matches += list(joined.finish())
    assert [match.driver.stamp for match in matches] == times
    assert all(match.scan and match.scan.stamp == match.driver.stamp + 10 for match in matches)


def test_the_label_stays_over_a_jump() -> None:
    joined = Synchroniser("image", [], 50, WINDOW, 10_000)
    matches = list(joined.push(Item(4990, "label", lambda: "office")))
    for time in [5000, 5100, 1000, 1100, 1200]:
        matches += list(joined.push(Item(time, "image", lambda: None)))
    matches += list(joined.finish())
    assert [match.label.value() for match in matches if match.label] == ["office"] * 5


@given(st.lists(st.integers(1, 100_000), max_size=60))
def test_every_driver_is_given_or_counted(times: list[int]) -> None:
    found, joined = stamps(times)
    assert len(found) + joined.late == len(times)
    assert set(found) <= set(times)


@given(st.lists(st.tuples(st.integers(10_000, 20_000), st.integers(2, 9)), min_size=1, max_size=6))
def test_stretches_of_steady_time_are_all_given(stretches: list[tuple[int, int]]) -> None:
    times = [start + 100 * i for start, length in stretches for i in range(length)]
    found, joined = stamps(times)
    if all(abs(a - b) > 2000 for (a, _), (b, _) in pairwise(stretches)):
        assert sorted(found) == sorted(times)
        assert joined.late == 0


def test_what_happened_to_the_time_is_told_once(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for i, t in enumerate([10.0, 10.1, 10.1, 10.2, 1.0, 1.1, 1.2, 1.3]):
        log.scan(t, [1.0], lag=20.0 - t + 0.1 * i)  # the log's own clock goes on
    opened = open_log(log.close())
    found = [each.stamp - START for each in opened]
    assert found == [round(t * SECOND) for t in [10.0, 10.1, 10.1, 10.2, 1.0, 1.1, 1.2, 1.3]]
    list(opened)
    apart, record = caplog.records
    assert "/scan 10.0 s behind" in apart.message  # the median of the first five: 10.0, 10.1 ...
    assert "1 jumps back in the time of scans" in record.message
    assert f"the first: at stamp {START + SECOND}" in record.message
    assert "1 scans have the stamp of the one before" in record.message


def test_unsorted_poses_are_put_in_order_and_unsorted_scans_are_counted(
    ros2: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = ros2()
    for t in [0.0, 0.3, 0.1, 0.2, 0.5, 0.4]:
        log.odom(t, 10 * t, 0.0, 0.0)
    for i, t in enumerate([0.0, 0.2, 0.1, 0.4, 0.35]):
        log.scan(t, [1.0], lag=1.0 + 0.1 * i - t)
    found = list(open_log(log.close()))
    assert [each.stamp - START for each in found] == [0, 200_000_000, 400_000_000]
    assert [each.pose.x for each in found if each.pose] == pytest.approx([0.0, 2.0, 4.0])
    (record,) = caplog.records
    assert "2 scans came behind ones of a later time and were left out" in record.message
