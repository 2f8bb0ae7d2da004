from __future__ import annotations

import csv
import io
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from placecue.faults import Faults
from placecue_sources import cure, stamps
from placecue_sources.text_records import PoseTrack, TextRecords, words
from recordings import DATA, needs_data, odometry_line, ramp, scan_line

#: The plan that comes with the data: pixels a metre, and the pixel of the origin.
SCALE, COLUMN, ROW = 28.011, 3.227, 700.938


def records(*lines: str, faults: Faults | None = None) -> TextRecords:
    text = io.BytesIO("\n".join(lines).encode())
    return TextRecords(text, "scans.tdf", cure.stamp, faults or Faults("test"))


def test_a_scan_begins_on_the_right_and_knows_what_was_not_measured() -> None:
    scan = cure.scan(scan_line("7.000001", [1.0, 32.767, 3.0, 31.9, 5.0], 0.5).encode().split())
    np.testing.assert_allclose(scan.angles, [-1.0, -0.5, 0.0, 0.5, 1.0])
    np.testing.assert_allclose(scan.ranges, [1.0, 32.767, 3.0, 31.9, 5.0])
    assert scan.valid().tolist() == [True, False, True, True, True]
    assert scan.range_max == 32.0


def test_idol2s_361_beams_cover_half_a_turn() -> None:
    scan = cure.scan(scan_line("7.0", ramp(0, 361)).encode().split())
    np.testing.assert_allclose(np.rad2deg(scan.angles[[0, 180, 360]]), [-90, 0, 90], atol=1e-4)


def test_settings_of_the_scanner_can_be_given() -> None:
    fields = scan_line("7.0", [1.0, 2.0, 3.0]).encode().split()
    scan = cure.scan(fields, field_of_view=90, max_range=2.5)
    np.testing.assert_allclose(np.rad2deg(scan.angles), [-45, 0, 45])
    assert scan.valid().tolist() == [True, True, False]


@pytest.mark.parametrize("change", [-1, 1])
def test_a_wrong_number_of_beams_is_told(change: int) -> None:
    fields = scan_line("7.0", [1.0, 2.0, 3.0]).encode().split()
    with pytest.raises(ValueError, match=f"3 beams promised, {3 + change} ranges there"):
        cure.scan(fields[:-1] if change < 0 else [*fields, b"9"])


@pytest.mark.parametrize("fields", [13, 14])
def test_the_heading_of_odometry_goes_by_the_number_of_fields(fields: int) -> None:
    line = odometry_line("7.5", 1.5, -2.5, 0.25, fields)
    assert len(line.split()) == fields
    assert cure.odometry(line.encode().split()) == (1.5, -2.5, 0.25)


def test_odometry_with_another_number_of_fields_is_refused() -> None:
    with pytest.raises(ValueError, match="12 fields where 13 or 14 are due"):
        cure.odometry(odometry_line("7.5", 1, 2, 3).encode().split()[:12])


def test_records_are_looked_up_by_time_whatever_their_order() -> None:
    faults = Faults("test")
    lines = [scan_line(f"{t}.000000", [float(t)]) for t in (3, 1, 2, 2, 5)]
    found = records(*lines, "", "2 0 nonsense", "# a note", faults=faults)
    second = 10**9
    assert found.stamps.tolist() == [second, 2 * second, 3 * second, 5 * second]
    assert [float(found.fields(k)[-1]) for k in range(4)] == [1, 2, 3, 5]
    assert found.nearest(3_400_000_000, second // 2) == 2
    assert found.nearest(4 * second, second // 2) is None
    assert faults.counts == {
        "lines do not parse and were left out": 1,
        "lines out of order of time were sorted": 3,
        "lines repeat the time of another and were left out": 1,
    }


def test_seconds_and_microseconds_are_exact() -> None:
    found = records(scan_line("1138915496.763684", [1.0]), scan_line("1138915527.000007", [1.0]))
    assert found.stamps.tolist() == [1138915496763684000, 1138915527000007000]


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.integers(0, 10**9), min_size=1, max_size=30),
    st.integers(-(10**9), 2 * 10**9),
    st.integers(0, 10**9),
)
def test_nearest_is_what_a_search_of_all_finds(
    times: list[int], stamp: int, tolerance: int
) -> None:
    found = np.unique(np.array(times, dtype=np.int64))
    best = int(np.abs(found - stamp).min())
    index = stamps.nearest(found, stamp, tolerance)
    assert (index is None) == (best > tolerance)
    if index is not None:
        assert abs(int(found[index]) - stamp) == best


def test_poses_are_interpolated_the_shorter_way_round() -> None:
    found = records(
        odometry_line("1.000000", 0, 0, 6.2),
        odometry_line("2.000000", 1, 2, 0.1),
        odometry_line("3.000000", 1, 2, 0.1, 13)[:-4],
    )
    track = PoseTrack(found, cure.odometry, "odom")
    pose = track.at(1_500_000_000, 10**9)
    assert pose is not None
    assert (pose.x, pose.y, pose.frame) == (pytest.approx(0.5), pytest.approx(1), "odom")
    assert np.cos(pose.theta - (6.2 + 0.1 + 2 * np.pi) / 2) == pytest.approx(1)
    assert track.at(9 * 10**9, 10**9) is None
    assert sum(found.faults.counts.values()) == 1


def test_blanks_and_commas_separate() -> None:
    assert words(b"1, 2.5\t3,4\r\n") == [b"1", b"2.5", b"3", b"4"]


@needs_data
def test_real_scans_meet_the_walls_of_the_plan() -> None:
    """Laid at their poses, most end points lie within a few centimetres of what is drawn."""
    folder = Path(str(DATA)) / "idol2"
    plan = cv2.imread(str(folder / "map.png"), cv2.IMREAD_UNCHANGED)
    drawn = (plan[..., 3] > 127) & (plan[..., :3].min(axis=-1) < 128)
    distance = distance_transform_edt(~drawn) / SCALE
    with (folder / "scans_sample.csv").open(newline="") as file:
        poses = [row for row in csv.DictReader(file) if row["x"]]
    with (folder / "scans_sample.tdf").open("rb") as file:
        found = TextRecords(file, "scans", cure.stamp, Faults("real"))
        scans = [cure.scan(found.fields(k)) for k in range(len(found))]
        times = found.stamps
    assert len(scans) == 8
    assert [scan.ranges.size for scan in scans] == [361] * 8
    assert [int((~scan.valid()).sum()) for scan in scans] == [0, 0, 0, 0, 0, 3, 0, 0]
    medians = {1: [], -1: []}
    for row in poses:
        index = stamps.nearest(times, stamps.nanoseconds(row["scan_stamp"]), 0)
        assert index is not None
        scan, theta = scans[index], float(row["theta"])
        for side in medians:
            bearings = theta + side * scan.angles[scan.valid()]
            lengths = scan.ranges[scan.valid()]
            columns = COLUMN + SCALE * (float(row["x"]) + lengths * np.cos(bearings))
            rows = ROW - SCALE * (float(row["y"]) + lengths * np.sin(bearings))
            columns, rows = np.rint(columns).astype(int), np.rint(rows).astype(int)
            inside = (columns >= 0) & (rows >= 0)
            inside &= (columns < drawn.shape[1]) & (rows < drawn.shape[0])
            medians[side].append(np.median(distance[rows[inside], columns[inside]]))
    assert max(medians[1]) < 0.11
    assert np.median(medians[1]) < 0.06
    # Mirrored scans do not fit, so the sense of the beams is the one that is read.
    assert np.median(medians[-1]) > 2 * np.median(medians[1])
