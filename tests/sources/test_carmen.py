from __future__ import annotations

import gzip
import logging
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from placecue.errors import DataError, UsageError
from placecue.observation import Observation
from placecue_sources.carmen import CarmenLog
from placecue_sources.order import InOrder

DATA = os.environ.get("PLACECUE_DATA")
needs_data = pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")


def flaser(stamp: float | str, ranges: Sequence[float], pose: str = "1 2 0.5 3 4 -0.5") -> str:
    readings = " ".join(f"{r:.2f}" for r in ranges)
    return f"FLASER {len(ranges)} {readings} {pose} {stamp} host {stamp}"


def robotlaser(stamp: float, ranges: Sequence[float], poses: str) -> str:
    readings = " ".join(f"{r:.2f}" for r in ranges)
    settings = "0 -1.5 3.0 0.5 30.0 0.1 0"
    return f"ROBOTLASER1 {settings} {len(ranges)} {readings} 2 7 9 {poses} 0 0 0 0 0 {stamp} h 1.0"


def odom(stamp: float, x: float = 0.0) -> str:
    return f"ODOM {x} 0 0 0.1 0 0 {stamp} host {stamp}"


def write(folder: Path, *lines: str, name: str = "run.log") -> str:
    path = folder / name
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def test_flaser_record(tmp_path: Path) -> None:
    ranges = np.arange(1, 181) / 10
    ranges[7] = 81.91
    (seen,) = CarmenLog(write(tmp_path, "# a comment", "", flaser("12.000000001", ranges)))
    assert seen.stamp == 12_000_000_001
    assert seen.scan is not None
    assert seen.pose is not None
    np.testing.assert_allclose(seen.scan.ranges, ranges)
    np.testing.assert_allclose(np.rad2deg(seen.scan.angles), np.arange(-90, 90))
    assert np.flatnonzero(~seen.scan.valid()).tolist() == [7]
    assert seen.scan.filled()[7] == 80.0
    assert (seen.pose.x, seen.pose.y, seen.pose.theta, seen.pose.frame) == (1, 2, 0.5, "map")


def test_odometry_of_a_scan(tmp_path: Path) -> None:
    (seen,) = CarmenLog(write(tmp_path, flaser(1, [1.0] * 4)), pose="odometry")
    assert seen.pose is not None
    assert (seen.pose.x, seen.pose.y, seen.pose.theta, seen.pose.frame) == (3, 4, -0.5, "odom")


@pytest.mark.parametrize(
    ("beams", "field_of_view", "first", "last"),
    [
        (181, None, -90, 90),
        (361, None, -90, 90),
        (180, None, -90, 89),
        (360, None, -90, 89.5),
        (541, 270.0, -135, 135),
        (360, 360.0, -180, 179),
    ],
)
def test_directions_of_beams(
    tmp_path: Path, beams: int, field_of_view: float | None, first: float, last: float
) -> None:
    log = CarmenLog(write(tmp_path, flaser(1, [2.0] * beams)), field_of_view=field_of_view)
    scan = next(iter(log)).scan
    assert scan is not None
    np.testing.assert_allclose(np.rad2deg(scan.angles[[0, -1]]), [first, last])
    np.testing.assert_allclose(np.diff(scan.angles), scan.angles[1] - scan.angles[0])


def test_robotlaser_record(tmp_path: Path) -> None:
    # The robot stands at (2, 1) and looks along y; its laser is 0.3 m ahead and 0.1 m to the left.
    poses = f"1.9 1.3 {np.pi / 2 + 0.2} 2 1 {np.pi / 2}"
    (seen,) = CarmenLog(write(tmp_path, robotlaser(5.5, [1, 2, 31, 4, 5, 6, 7], poses)))
    assert seen.stamp == 5_500_000_000
    assert seen.scan is not None
    assert seen.pose is not None
    np.testing.assert_allclose(seen.scan.angles, [-1.5, -1, -0.5, 0, 0.5, 1, 1.5])
    assert seen.scan.valid().tolist() == [True, True, False, True, True, True, True]
    assert seen.scan.range_max == 30.0
    mount = seen.scan.mount
    np.testing.assert_allclose((mount.x, mount.y, mount.theta), (0.3, 0.1, 0.2), atol=1e-12)
    assert (seen.pose.x, seen.pose.y, seen.pose.frame) == (2, 1, "map")


def test_settings_of_the_scanner_can_be_given(tmp_path: Path) -> None:
    path = write(tmp_path, robotlaser(5, [1, 2, 31, 4, 5], "0 0 0 0 0 0"))
    scan = next(iter(CarmenLog(path, field_of_view=90, max_range=3))).scan
    assert scan is not None
    np.testing.assert_allclose(np.rad2deg(scan.angles), [-45, -22.5, 0, 22.5, 45])
    assert scan.valid().tolist() == [True, True, False, False, False]


def test_odometry_alone(tmp_path: Path) -> None:
    path = write(tmp_path, odom(1, 0.5), flaser(2, [1.0] * 4), odom(3, 0.7), odom(0, 9.0))
    seen = list(CarmenLog(path, parts=["pose"]))
    assert [o.pose.x for o in seen if o.pose] == [0.5, 0.7]
    assert all(o.scan is None and o.pose and o.pose.frame == "odom" for o in seen)
    assert CarmenLog(path, parts=["pose"]).count() == 2


def test_scans_alone(tmp_path: Path) -> None:
    (seen,) = CarmenLog(write(tmp_path, flaser(2, [1.0] * 4)), parts=["scan"])
    assert seen.has("scan")
    assert not seen.has("pose")


def test_only_the_first_of_two_kinds_is_read(tmp_path: Path) -> None:
    poses = "0 0 0 0 0 0"
    path = write(tmp_path, flaser(1, [1.0]), robotlaser(1, [1.0], poses), flaser(2, [1.0]))
    assert CarmenLog(path).count() == 2


def test_compression_is_told_by_content(tmp_path: Path) -> None:
    text = "\n".join(flaser(k + 1, [1.0, 2.0]) for k in range(5)) + "\n"
    packed = tmp_path / "packed.log"
    packed.write_bytes(gzip.compress(text.encode()))
    plain = tmp_path / "plain.log.gz"
    plain.write_text(text)
    for path in (packed, plain):
        assert [o.stamp for o in CarmenLog(str(path))] == [k * 10**9 for k in range(1, 6)]


def test_lines_are_put_in_order_of_time(tmp_path: Path) -> None:
    times = [3, 1, 2, 0, 5, 4]
    path = write(tmp_path, *(flaser(t, [1.0]) for t in times))
    assert [o.stamp // 10**9 for o in CarmenLog(path)] == [1, 2, 3, 4, 5]


def test_lines_too_late_are_left_out_and_counted(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = write(tmp_path, *(flaser(t, [1.0]) for t in (2, 3, 4, 5, 1, 6)))
    log = CarmenLog(path, reorder=2)
    assert [o.stamp // 10**9 for o in log] == [2, 3, 4, 5, 6]
    assert "1 records are too far out of order" in caplog.text
    assert log.count() == 5


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.integers(0, 20), max_size=40).map(lambda steps: np.arange(len(steps)) * 10 + steps)
)
def test_a_window_sorts_what_is_displaced_less(stamps: np.ndarray) -> None:
    # A stamp is at most 20 late and they come 10 apart, so a window of 3 is enough.
    ordered = InOrder([Observation(int(s)) for s in stamps], 3)
    assert [o.stamp for o in ordered] == sorted(stamps.tolist())
    assert ordered.late == 0


BROKEN = [
    "FLASER",
    "FLASER x",
    "FLASER 3 1 2 3",
    "FLASER 999999999 1 2 3 0 0 0 0 0 0 1 h 1",
    "FLASER 0 0 0 0 0 0 0 1 h 1",
    "FLASER -1 0 0 0 0 0 0 1 h 1",
    "FLASER 2 1 two 0 0 0 0 0 0 1 h 1",
    "FLASER 2 1 2 0 0 nan 0 0 0 1 h 1",
    "FLASER 2 1 2 1e300 0 0 0 0 0 1 h 1",
    "FLASER 2 1 2 0 0 0 0 0 0 nan h 1",
    "FLASER 2 1 2 0 0 0 0 0 0 inf h 1",
    "FLASER 2 1 2 0 0 0 0 0 0 1e999999999 h 1",
    "FLASER 2 1 2 0 0 0 0 0 0 1e15 h 1",
    "FLASER 2 1 2 0 0 0 0 0 0 \xff h 1",
    "FLASER 3 1 2 0 0 0 0 0 0 1 h 1",
]


def test_broken_lines_are_counted_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write(tmp_path, flaser(1, [1.0]), *BROKEN, flaser(2, [1.0]))
    with caplog.at_level(logging.WARNING):
        assert len(list(CarmenLog(path))) == 2
    assert len(caplog.records) == 1
    assert f"{len(BROKEN)} lines do not parse" in caplog.text
    assert "line 2, FLASER" in caplog.text


@settings(max_examples=100, deadline=None)
@given(garbage=st.binary(max_size=200))
def test_no_garbage_gives_another_error(
    tmp_path_factory: pytest.TempPathFactory, garbage: bytes
) -> None:
    path = tmp_path_factory.mktemp("garbage") / "run.log"
    path.write_bytes(b"FLASER 2 " + garbage + b"\n" + flaser(1, [1.0]).encode() + b"\n" + garbage)
    assert CarmenLog(str(path)).count() >= 1


def test_a_cut_gzip_gives_what_is_readable(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    rng = np.random.default_rng(0)
    text = "\n".join(flaser(k + 1, rng.uniform(1, 9, 100)) for k in range(300)) + "\n"
    whole = gzip.compress(text.encode())
    path = tmp_path / "cut.log.gz"
    path.write_bytes(whole[: len(whole) // 2])
    seen = list(CarmenLog(str(path)))
    assert 50 < len(seen) < 300
    assert "cut or damaged after line" in caplog.text


def test_an_unreadable_gzip_is_a_data_error(tmp_path: Path) -> None:
    path = tmp_path / "bad.log.gz"
    path.write_bytes(b"\x1f\x8b\x00nothing that gzip knows")
    with pytest.raises(DataError, match="not a CARMEN log"):
        list(CarmenLog(str(path)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "not a CARMEN log"),
        ("time,range\n1,2\n", "not a CARMEN log"),
        (odom(1) + "\n" + odom(2), "no FLASER or ROBOTLASER1 record .* it has ODOM 2"),
        (flaser(0, [1.0]), "time after 0"),
        ("FLASER 3 1", "that parses; the first: line 1, FLASER"),
    ],
)
def test_nothing_of_use_is_a_data_error(tmp_path: Path, content: str, message: str) -> None:
    path = write(tmp_path, content)
    with pytest.raises(DataError, match=message) as caught:
        list(CarmenLog(path))
    assert "\n" not in str(caught.value)
    assert path in str(caught.value)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"laser": "frnt"}, "did you mean 'front'"),
        ({"pose": "slam"}, "available: corrected, odometry"),
        ({"parts": ["image"]}, "available: pose, scan"),
        ({"parts": []}, "available: pose, scan"),
        ({"max_range": -1}, "above 0"),
        ({"reorder": 1.5}, "whole number"),
    ],
)
def test_wrong_parameters_are_usage_errors(
    tmp_path: Path, parameters: dict[str, object], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        list(CarmenLog(write(tmp_path, flaser(1, [1.0])), **parameters))  # type: ignore[arg-type]


def test_missing_file_and_folder_are_usage_errors(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no file"):
        list(CarmenLog(str(tmp_path / "none.log")))
    with pytest.raises(UsageError, match="folder"):
        CarmenLog(str(tmp_path)).digest()


def test_digest_follows_content_and_parameters_not_the_name(tmp_path: Path) -> None:
    one = write(tmp_path, flaser(1, [1.0]), name="a.log")
    same = write(tmp_path, flaser(1, [1.0]), name="b.log")
    other = write(tmp_path, flaser(1, [1.5]), name="c.log")
    digest = CarmenLog(one).digest()
    assert digest == CarmenLog(same).digest()
    assert digest != CarmenLog(other).digest()
    assert digest != CarmenLog(one, pose="odometry").digest()
    assert CarmenLog(one).name == "a.log"
    assert CarmenLog(one).metadata["laser"] == "front"


@needs_data
@pytest.mark.parametrize(
    ("name", "scans", "seconds", "metres"),
    [
        ("freiburg-079-corrected", 4791, 1061, 422),
        ("freiburg-101-corrected", 292, None, 211),
        ("intel-corrected", 910, None, 500),
        ("freiburg-079-robotlaser", 1464, None, None),
    ],
)
def test_real_logs(name: str, scans: int, seconds: float | None, metres: float | None) -> None:
    """Counts, duration and path length are those given with the data."""
    log = CarmenLog(str(Path(str(DATA)) / "carmen" / f"{name}.log.gz"))
    stamps, positions = [], []
    for observation in log:
        assert observation.scan is not None
        assert observation.pose is not None
        stamps.append(observation.stamp)
        positions.append((observation.pose.x, observation.pose.y))
    assert len(stamps) == log.count() == scans
    assert stamps == sorted(stamps)
    if seconds is not None:
        assert (stamps[-1] - stamps[0]) / 1e9 == pytest.approx(seconds, abs=1)
    if metres is not None:
        assert np.hypot(*np.diff(positions, axis=0).T).sum() == pytest.approx(metres, rel=0.005)


@needs_data
def test_walls_of_a_real_log_are_sharpest_as_read() -> None:
    """Turning the laser, or mirroring its scans, must blur the map drawn from the poses."""
    log = CarmenLog(str(Path(str(DATA)) / "carmen" / "intel-corrected.log.gz"))
    observations = list(log)[::2]

    def occupied_cells(turn: float, mirror: int) -> int:
        cells = []
        for observation in observations:
            scan, pose = observation.scan, observation.pose
            assert scan is not None
            assert pose is not None
            near = scan.valid() & (scan.ranges < 15)
            bearings = pose.theta + mirror * scan.angles[near] + turn
            ends = scan.ranges[near, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
            cells.append(np.floor((np.array([pose.x, pose.y]) + ends) / 0.05))
        return len(np.unique(np.concatenate(cells), axis=0))

    half_a_beam = np.deg2rad(0.5)
    as_read = occupied_cells(0.0, 1)
    assert as_read < occupied_cells(half_a_beam, 1)
    assert as_read < occupied_cells(-half_a_beam, 1)
    assert 1.5 * as_read < occupied_cells(0.0, -1)
