from __future__ import annotations

import contextlib
import logging
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from placecue.errors import DataError, UsageError
from placecue.logs import McapLog
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue.observation import EncodedImage
from placecue_sources.idol2 import Idol2
from placecue_sources.image_names import parse
from recordings import (
    drive,
    idol2_folder,
    idol2_name,
    needs_data,
    odometry_line,
    packed,
    picture,
    ramp,
    recorded,
    same,
    scan_line,
    write,
)


def test_everything_is_read(tmp_path: Path) -> None:
    samples = drive()
    found = list(Idol2(str(idol2_folder(tmp_path, samples))))
    assert [o.stamp for o in found] == [s.nanoseconds for s in samples]
    assert [o.label for o in found] == [s.label for s in samples]
    for number, (observation, sample) in enumerate(zip(found, samples, strict=True)):
        pose, scan = observation.pose, observation.scan
        assert pose is not None
        assert scan is not None
        assert pose.frame == "map"
        np.testing.assert_allclose(
            (pose.x, pose.y, pose.theta), (sample.x, sample.y, sample.theta), rtol=1e-5, atol=1e-5
        )
        np.testing.assert_allclose(scan.ranges, ramp(number, 361))
        assert isinstance(observation.image_source, EncodedImage)
        assert observation.image_source.data == picture(number)
        assert observation.image is not None
        assert observation.image.mean() == number


def test_the_name_tells_the_conditions(tmp_path: Path) -> None:
    folder = idol2_folder(tmp_path, drive(), "min_sunny3")
    assert Idol2(str(folder)).metadata == {
        "dataset": "idol2",
        "sequence": "min_sunny3",
        "platform": "min",
        "illumination": "sunny",
        "run": "3",
    }
    given_run = Idol2(str(folder), conditions={"run": "4", "weather": "snow"}).metadata
    assert (given_run["run"], given_run["weather"]) == ("4", "snow")
    assert Idol2(str(folder / "png")).metadata["illumination"] == "sunny"


@pytest.mark.parametrize(
    ("suffix", "mode"),
    [(".tar", "w"), (".tar.gz", "w:gz"), (".tar.bz2", "w:bz2"), (".tar.xz", "w:xz")],
)
def test_a_tar_gives_the_same_as_its_folder(tmp_path: Path, suffix: str, mode: str) -> None:
    folder = idol2_folder(tmp_path, drive())
    tar = Idol2(str(packed(folder, tmp_path / f"dum_cloudy1{suffix}", mode)))
    unpacked = Idol2(str(folder))
    same(tar, unpacked)
    assert tar.count() == unpacked.count() == 12
    assert tar.digest() == unpacked.digest()
    assert tar.metadata == unpacked.metadata
    assert tar.name == "dum_cloudy1"


def test_a_tar_in_a_wild_order_gives_the_same(tmp_path: Path) -> None:
    folder = idol2_folder(tmp_path, drive())
    same(Idol2(str(packed(folder, tmp_path / "a.tar", shuffled=True))), Idol2(str(folder)))


def test_the_folder_of_images_itself_can_be_named(tmp_path: Path) -> None:
    folder = idol2_folder(tmp_path, drive())
    found = list(Idol2(str(folder / "png"), scans=str(folder / "scans.tdf")))
    same(found, Idol2(str(folder)))


def test_poses_can_be_those_of_the_odometry(tmp_path: Path) -> None:
    samples = drive()
    folder = idol2_folder(tmp_path, samples)
    for observation, sample in zip(Idol2(str(folder), pose="odometry"), samples, strict=True):
        pose = observation.pose
        assert pose is not None
        assert pose.frame == "odom"
        assert (pose.x, pose.y) == (
            pytest.approx(sample.x + 5, rel=1e-5),
            pytest.approx(sample.y, abs=1e-5),
        )
        assert np.cos(pose.theta - sample.theta) == pytest.approx(1)


def test_without_scans_the_rest_is_read_and_it_is_said_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = idol2_folder(tmp_path, drive(), beams=0)
    found = list(Idol2(str(folder)))
    assert len(found) == 12
    assert all(o.scan is None and o.has("image") and o.has("pose") for o in found)
    assert len(caplog.records) == 1
    assert "no scans.tdf" in caplog.text
    with pytest.raises(DataError, match=r"no odom.tdf .* source.pose=corrected"):
        list(Idol2(str(folder), pose="odometry"))


def test_parts_leave_out_what_is_not_wanted(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = idol2_folder(tmp_path, drive(), beams=0)
    for observation in Idol2(str(folder), parts=["image", "label"]):
        assert not observation.has("pose")
        assert observation.has("label")
    assert not caplog.records


def test_scans_go_to_the_nearest_image_within_the_tolerance(tmp_path: Path) -> None:
    samples = drive(4)
    folder = idol2_folder(tmp_path, samples)
    # 80 ms after the first image, 90 ms before the third; images are 200 ms apart.
    lines = [scan_line("1138915484.180000", [1.0]), scan_line("1138915484.410000", [2.0])]
    write(folder / "scans.tdf", "\n".join(lines))

    def first_ranges(tolerance: float) -> list[float | None]:
        found = Idol2(str(folder), tolerance=tolerance)
        return [None if o.scan is None else float(o.scan.ranges[0]) for o in found]

    assert first_ranges(0.1) == [1.0, None, 2.0, None]
    assert first_ranges(0.15) == [1.0, 2.0, 2.0, None]
    assert first_ranges(0.05) == [None] * 4


def test_what_is_wrong_is_counted_and_said_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    samples = drive()
    folder = idol2_folder(tmp_path, samples)
    images = sorted((folder / "png").iterdir())
    images[3].write_bytes(b"")
    write(folder / "png" / "Thumbs.db", b"x")
    write(folder / "png" / "overview.png", picture(1))
    write(folder / "png" / f"t{samples[5].stamp}_rKT_x9_y9_a-1.5e-05.png", picture(9))
    lines = (folder / "scans.tdf").read_text().splitlines()
    lines[2] += " 7.5"
    lines[4] = " ".join(lines[4].split()[:-1])
    lines[6] = "2 0 361 what 5"
    lines[8], lines[9] = lines[9], lines[8]
    write(folder / "scans.tdf", "\n".join([*lines, lines[0]]))
    with caplog.at_level(logging.WARNING):
        found = list(Idol2(str(folder)))
    assert len(caplog.records) == 1
    for words in (
        "1 names of images do not parse and were left out (the first: overview.png)",
        "1 images have the time of another",
        "1 images cannot be read",
        "2 scans do not parse and were left out (the first: 361 beams promised, 362 ranges there)",
        "1 lines do not parse",
        "2 lines out of order",
        "1 lines repeat the time",
        "1 images have no scan near enough in time",
    ):
        assert words in caplog.text
    assert len(found) == 13
    assert sum(o.scan is None for o in found) == 3
    assert sum(not o.has("image") for o in found) == 1
    assert [o.stamp for o in found] == sorted(o.stamp for o in found)


def test_a_cut_tar_gives_what_is_whole(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = idol2_folder(tmp_path, drive())
    tar = packed(folder, tmp_path / "dum_night2.tar")
    whole = tar.read_bytes()
    # Entries are sorted, so scans.tdf comes last and is cut in the middle.
    used = len(whole.rstrip(b"\0"))
    tar.write_bytes(whole[: used - 8000])
    found = list(Idol2(str(tar)))
    assert len(found) == 12
    assert all(o.has("image") for o in found)
    assert 0 < sum(o.has("scan") for o in found) < 12
    assert "cut or damaged" in caplog.text
    caplog.clear()
    smaller = tmp_path / "cut.tar.gz"
    packed(folder, smaller, "w:gz", shuffled=True)
    smaller.write_bytes(smaller.read_bytes()[: smaller.stat().st_size // 2])
    assert 0 < len(list(Idol2(str(smaller)))) <= 12
    assert "cut or damaged" in caplog.text


def test_damage_inside_a_tar_costs_what_lies_there(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = idol2_folder(tmp_path, drive())
    tar = packed(folder, tmp_path / "dum_night2.tar")
    content = bytearray(tar.read_bytes())
    at = content.index(b"dum_cloudy1/png/t1138915484.900000")
    content[at : at + 300] = b"\xa5" * 300
    tar.write_bytes(content)
    assert len(list(Idol2(str(tar)))) == 11
    assert "1 places in the tar are cut or damaged" in caplog.text


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_no_damage_to_a_tar_gives_another_error(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    root = tmp_path_factory.mktemp("damage")
    tar = packed(idol2_folder(root, drive(3), beams=5), root / "dum_night2.tar")
    content = bytearray(tar.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + 40] = data.draw(st.binary(min_size=1, max_size=80))
    tar.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    with contextlib.suppress(DataError):
        assert all(observation.stamp > 0 for observation in Idol2(str(tar)))
    shutil.rmtree(root)


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"no tar at all", "neither a folder nor a tar"), (b"", "neither a folder nor a tar")],
)
def test_a_file_that_is_no_tar_is_a_data_error(
    tmp_path: Path, content: bytes, message: str
) -> None:
    with pytest.raises(DataError, match=message):
        list(Idol2(str(write(tmp_path / "a.tar", content))))


def test_wrong_paths_say_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no folder and no tar"):
        list(Idol2(str(tmp_path / "nothing")))
    write(tmp_path / "some" / "cat.png", picture(1))
    with pytest.raises(DataError, match=r"holds no images named like .* files such as cat.png"):
        list(Idol2(str(tmp_path / "some")))
    for name in ("dum_cloudy1", "dum_cloudy2"):
        idol2_folder(tmp_path / "all", drive(2), name)
    with pytest.raises(DataError, match=r"2 sequences \(dum_cloudy1/png, dum_cloudy2/png"):
        list(Idol2(str(tmp_path / "all")))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"pose": "slam"}, "available: corrected, odometry"),
        ({"parts": ["sound"]}, "available: image, label, pose, scan"),
        ({"parts": []}, "available: image"),
        ({"tolerance": -1}, "at least 0"),
        ({"max_range": 0}, "above 0"),
        ({"scans": "/nowhere/scans.tdf"}, "no file"),
    ],
)
def test_wrong_parameters_are_usage_errors(
    tmp_path: Path, parameters: dict[str, object], message: str
) -> None:
    folder = idol2_folder(tmp_path, drive(2))
    with pytest.raises(UsageError, match=message):
        list(Idol2(str(folder), **parameters))  # type: ignore[arg-type]


def test_the_digest_follows_content_and_parameters_not_the_place(tmp_path: Path) -> None:
    folder = idol2_folder(tmp_path / "a", drive())
    moved = idol2_folder(tmp_path / "b", drive())
    digest = Idol2(str(folder)).digest()
    assert digest == Idol2(str(moved)).digest()
    assert digest != Idol2(str(moved), pose="odometry").digest()
    write(moved / "scans.tdf", scan_line("1138915484.180000", [1.0]))
    assert digest != Idol2(str(moved)).digest()


@pytest.mark.parametrize(
    "name",
    ["t12.5_rKT_x1_y2.png", "t12.5_rKT_x1_y2_anan.png", "rKT_t1_x1_y2_a3.png", "t1_x1_y2_a3.gif"],
)
def test_other_names_say_nothing(name: str) -> None:
    assert parse(name) is None


@settings(max_examples=100, deadline=None)
@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(-7, 7), st.integers(0, 10**15))
def test_names_as_c_prints_them_are_read(x: float, y: float, a: float, micro: int) -> None:
    name = f"t{micro // 10**6}.{micro % 10**6:06d}_rPA_x{x:g}_y{y:g}_a{a:g}.png"
    moment = parse(name)
    assert moment is not None
    assert (moment.stamp, moment.label) == (micro * 1000, "PA")
    np.testing.assert_allclose(
        (moment.pose.x, moment.pose.y, moment.pose.theta), (x, y, a), rtol=1e-5, atol=1e-300
    )


def test_a_converted_sequence_is_the_same_log(tmp_path: Path) -> None:
    source = Idol2(str(packed(idol2_folder(tmp_path, drive()), tmp_path / "dum_cloudy1.tar")))
    out = tmp_path / "out.mcap"
    with McapWriter(out, metadata=source.metadata) as writer:
        assert copy(source, writer) == 12
    log = McapLog(str(out))
    assert log.metadata["illumination"] == "cloudy"
    for read, first in zip(log, source, strict=True):
        assert (read.stamp, read.label) == (first.stamp, first.label)
        assert isinstance(read.image_source, EncodedImage)
        assert isinstance(first.image_source, EncodedImage)
        assert read.image_source.data == first.image_source.data
        assert read.scan is not None
        assert first.scan is not None
        np.testing.assert_allclose(read.scan.ranges, first.scan.ranges, rtol=1e-6)
        np.testing.assert_allclose(read.scan.angles, first.scan.angles, atol=1e-6)


@needs_data
@pytest.mark.parametrize("sequence", ["dum_cloudy1", "dum_sunny4"])
def test_a_recorded_drive(tmp_path: Path, sequence: str) -> None:
    """Poses and labels come back through names as they were recorded; C's %g keeps 6 digits."""
    samples = recorded("idol2/poses.csv.gz", 300, sequence=sequence)
    folder = idol2_folder(tmp_path, samples, sequence, beams=31)
    source = Idol2(str(packed(folder, tmp_path / f"{sequence}.tar", shuffled=True)))
    found = list(source)
    assert [o.stamp for o in found] == [s.nanoseconds for s in samples]
    assert [o.label for o in found] == [s.label for s in samples]
    poses = np.array([(o.pose.x, o.pose.y, o.pose.theta) for o in found if o.pose])
    np.testing.assert_allclose(poses, [(s.x, s.y, s.theta) for s in samples], rtol=1e-5)
    assert all(o.has("scan") for o in found)
    assert source.metadata["illumination"] == sequence[4:-1]


def test_odometry_beside_a_tar(tmp_path: Path) -> None:
    samples = drive()
    folder = idol2_folder(tmp_path, samples, beams=0)
    lines = [odometry_line(s.stamp, s.x, s.y, s.theta) for s in samples]
    odometry = write(tmp_path / "logs" / "odom.tdf", "\n".join(lines))
    tar = packed(folder, tmp_path / "dum_cloudy1.tar")
    source = Idol2(str(tar), parts=["pose"], pose="odometry", odometry=str(odometry))
    assert [o.pose.x for o in source if o.pose] == pytest.approx([s.x for s in samples], rel=1e-5)
    assert idol2_name(samples[0]) in str(sorted((folder / "png").iterdir())[0])
