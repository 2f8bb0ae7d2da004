"""RGB-D data sets: small ones made here, and the recorded frames of NYU Depth v2."""

from __future__ import annotations

import csv
import logging
import math
import os
from collections import Counter
from importlib.resources import files
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml

from placecue.errors import DataError, UsageError
from placecue.logs import open_log
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue.observation import EncodedImage
from placecue_sources.rgbd import RGBD

DATA = os.environ.get("PLACECUE_DATA")
needs_data = pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")

SMALL = {"fx": 40.0, "cx": 31.5, "cy": 23.5, "band": 8}
LINES = [
    "frame,room,rgb,depth,time",
    "a,office,rgb/a.jpg,depth/a.png,3.5",
    "b,kitchen,rgb/b.jpg,depth/b.png,1.25",
    "c,office,rgb/c.jpg,depth/c.png,2",
    "d,,rgb/d.jpg,depth/d.png,4",
]
TABLE: dict[str, Any] = {"labels": "labels.csv", "label_column": "room", "stamp_column": "time"}


def picture(path: Path, pixels: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    ok, data = cv2.imencode(path.suffix, pixels)
    assert ok
    path.write_bytes(data.tobytes())


def frame(folder: Path, name: str, metres: float, shade: int = 100) -> None:
    """Write a grey picture and a wall at some distance, in mm."""
    picture(folder / "rgb" / f"{name}.jpg", np.full((48, 64, 3), shade, np.uint8))
    picture(folder / "depth" / f"{name}.png", np.full((48, 64), round(metres * 1000), np.uint16))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for number, name in enumerate("abcd", start=1):
        frame(tmp_path, name, metres=number + 0.25, shade=20 * number)
    (tmp_path / "labels.csv").write_text("\n".join(LINES) + "\n")
    return tmp_path


def test_a_table_of_frames(folder: Path) -> None:
    source = RGBD(str(folder), **TABLE, **SMALL)
    seen = list(source)
    # In order of the times in the table: b, c, a, d.
    assert [each.stamp for each in seen] == [1_250_000_000, 2 * 10**9, 3_500_000_000, 4 * 10**9]
    assert [each.label for each in seen] == ["kitchen", "office", "office", None]
    assert [each.pose for each in seen] == [None] * 4
    ahead = [each.scan.ranges[np.abs(each.scan.angles).argmin()] for each in seen if each.scan]
    assert ahead == pytest.approx([2.25, 3.25, 1.25, 4.25], abs=1e-3)
    shades = [each.image.mean() for each in seen if each.image is not None]
    assert shades == pytest.approx([40, 60, 20, 80], abs=2)
    assert source.count() == len(seen)


def test_scenes_from_a_column(folder: Path) -> None:
    scenes = ["scene", "attic", "1", "attic", ""]
    lines = [f"{line},{scene}" for line, scene in zip(LINES, scenes, strict=True)]
    (folder / "labels.csv").write_text("\n".join(lines))
    source = RGBD(str(folder), **TABLE, **SMALL, scene_column="scene")
    assert [each.scene for each in source] == ["1", "attic", "attic", None]
    assert source.digest() != RGBD(str(folder), **TABLE, **SMALL).digest()


def test_scenes_from_cuts(folder: Path) -> None:
    # The frames have the times 1.25, 2, 3.5 and 4 s.
    def scenes(cuts: list[float]) -> list[str | None]:
        return [each.scene for each in RGBD(str(folder), **TABLE, **SMALL, cuts=cuts)]

    assert scenes([2, 3.75]) == ["0", "1", "1", "2"]
    assert scenes([0, 3.5]) == ["1", "1", "2", "2"]
    # Leaving out a class moves no cut.
    kept = RGBD(str(folder), **TABLE, **SMALL, cuts=[2, 3.75], classes=["office"])
    assert [each.scene for each in kept] == ["1", "1"]


def test_pictures_stay_undecoded(folder: Path) -> None:
    first = next(iter(RGBD(str(folder), **TABLE, **SMALL)))
    assert isinstance(first.image_source, EncodedImage)
    assert first.image_source.data == (folder / "rgb" / "b.jpg").read_bytes()


def test_two_folders_without_a_table(folder: Path) -> None:
    for name in ("d9", "d10"):
        frame(folder, name, 1.0)
    source = RGBD(str(folder), rate=10.0, **SMALL)
    assert [each.stamp for each in source] == [n * 100_000_000 for n in range(1, 7)]
    assert {each.label for each in source} == {None}
    ahead = [each.scan.ranges.min() for each in source if each.scan]
    # d9 comes before d10.
    assert ahead == pytest.approx([1.25, 2.25, 3.25, 4.25, 1.0, 1.0], abs=0.01)


def test_the_unit_of_the_depth(tmp_path: Path) -> None:
    picture(tmp_path / "depth" / "a.png", np.full((48, 64), 51, np.uint8))
    (seen,) = RGBD(str(tmp_path), depth_scale=1 / 25.5, **SMALL)
    assert seen.image is None
    assert seen.scan is not None
    assert seen.scan.points()[:, 0] == pytest.approx(2.0, abs=0.03)


def test_parameters_of_the_scan(folder: Path) -> None:
    options = {"step": 2.0, "range_min": 0.3, "range_max": 4.5, "mount": [0.1, 0.2, 90.0]}
    scan = next(iter(RGBD(str(folder), **SMALL, **options))).scan
    assert scan is not None
    assert np.rad2deg(np.diff(scan.angles)) == pytest.approx(2.0)
    assert (scan.range_min, scan.range_max) == (0.3, 4.5)
    assert (scan.mount.x, scan.mount.y, scan.mount.theta) == pytest.approx((0.1, 0.2, math.pi / 2))


@pytest.mark.parametrize(
    ("options", "labels"),
    [
        ({"min_frames": 2}, ["office", "office", None]),
        ({"classes": ["kitchen"]}, ["kitchen"]),
        ({"classes": ["kitchen", "office"], "min_frames": 2}, ["office", "office"]),
    ],
)
def test_some_classes_only(folder: Path, options: dict[str, Any], labels: list[str]) -> None:
    source = RGBD(str(folder), **TABLE, **SMALL, **options)
    assert [each.label for each in source] == labels
    assert source.count() == len(labels)


@pytest.mark.parametrize("parts", [["image"], ["scan", "label"], ["scan", "image"], None])
def test_only_the_wanted_parts_are_read(folder: Path, parts: list[str] | None) -> None:
    source = RGBD(str(folder), **TABLE, **SMALL, parts=parts)
    for each in source:
        assert each.has("image") == (parts is None or "image" in parts)
        assert each.has("scan") == (parts is None or "scan" in parts)
    assert source.digest() == RGBD(str(folder), **TABLE, **SMALL).digest()


def test_the_digest_is_that_of_the_content(folder: Path, tmp_path_factory: Any) -> None:
    def digest(path: Path, **options: Any) -> str:
        return RGBD(str(path), **TABLE, **{**SMALL, **options}).digest()

    before = digest(folder)
    other = tmp_path_factory.mktemp("other")
    for name in ("rgb", "depth"):
        (other / name).mkdir()
        for path in (folder / name).iterdir():
            (other / name / path.name).write_bytes(path.read_bytes())
    (other / "labels.csv").write_text("\n".join(LINES) + "\n")
    assert digest(other) == before
    assert digest(other, band=9) != before
    assert digest(other, classes=["office"]) != before
    (other / "labels.csv").write_text("\n".join(LINES).replace("kitchen", "bath"))
    assert digest(other) != before
    (other / "labels.csv").write_text("\n".join(LINES) + "\n")
    frame(other, "a", 1.5, shade=20)
    assert digest(other) != before


def test_what_is_missing_or_broken_is_said_once(
    folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (folder / "rgb" / "a.jpg").unlink()
    (folder / "depth" / "b.png").write_bytes(b"no picture")
    picture(folder / "depth" / "c.png", np.zeros((48, 64, 3), np.uint8))
    source = RGBD(str(folder), **TABLE, **SMALL)
    with caplog.at_level(logging.WARNING):
        seen = list(source)
    assert [(each.has("image"), each.has("scan")) for each in seen] == [
        (True, False),
        (True, False),
        (False, True),
        (True, True),
    ]
    (record,) = caplog.records
    assert "3 parts of 4 frames cannot be read (the first: " in record.message
    assert "b.png does not decode (10 bytes)" in record.message
    assert len(source.digest()) == 64


def test_a_data_set_of_which_nothing_can_be_read(folder: Path) -> None:
    for path in folder.glob("*/*.*"):
        path.unlink()
    with pytest.raises(DataError, match=r"8 parts of 4 frames cannot be read .*b\.jpg cannot be"):
        list(RGBD(str(folder), **TABLE, **SMALL))


def test_intrinsics_of_another_size(folder: Path) -> None:
    with pytest.raises(DataError, match=r"a\.png: the optical axis at column 319.5, row 239.5 is"):
        list(RGBD(str(folder), parts=["scan"]))


def test_a_column_that_is_not_wanted(folder: Path) -> None:
    source = RGBD(str(folder), **TABLE, **SMALL, depth_column=None)
    assert all(each.has("image") and not each.has("scan") for each in source)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"path": "/nowhere"}, "there is no folder /nowhere"),
        ({"label_column": "rom"}, "no column 'rom'; did you mean 'room'?"),
        ({"image_column": "image"}, "available: depth, frame, rgb, room, time"),
        ({"classes": ["offce"]}, "no frame of the class 'offce'; did you mean 'office'?"),
        ({"min_frames": 3, "classes": ["office"]}, "the largest class, 'office', has 2"),
        ({"parts": ["depth"]}, "parts is 'depth'"),
        ({"band": 0}, "band is 0"),
        ({"percentile": 101.0}, "percentile is 101.0; give a number from 0 to 100"),
        ({"min_valid": 1.5}, "min_valid is 1.5; give a number from 0 to 1"),
        ({"depth_scale": 0}, "depth_scale is 0; give a number above 0"),
        ({"step": -1}, "step is -1"),
        ({"mount": [0.0, 1.0]}, "give x, y"),
        ({"scene_column": "scene"}, "no column 'scene'; available: depth"),
        ({"cuts": "nyu2"}, "cuts has no list 'nyu2'; did you mean 'nyuv2'?"),
        ({"cuts": [2, 1.5]}, "cuts has 1.5 s after 2 s: give them in order"),
        ({"cuts": [2, "b"]}, "cuts is 'b'; give a number"),
        ({"cuts": [1], "scene_column": "room"}, "cuts and scene_column both tell scenes"),
    ],
)
def test_parameters_that_cannot_be(folder: Path, options: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message.replace("?", r"\?")) as raised:
        list(RGBD(**{"path": str(folder), **TABLE, **SMALL, **options}))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("room,rgb,depth,time\n", "lists no frame"),
        ("room,rgb,depth,time\noffice,a,b,soon\n", "'time' of .*, line 2: 'soon' is no time in s"),
        ("room,rgb,depth,time\noffice,a,b,nan\n", "'time' of .*, line 2: 'nan' is no time in s"),
        ("room,rgb,depth,time\noffice,a\n", "'time' of .*, line 2: '' is no time in s"),
        ("\xff\xfe", "has no column 'rgb'"),
        ("", "has no column 'rgb'; available: none"),
    ],
)
def test_tables_that_make_no_sense(folder: Path, text: str, message: str) -> None:
    (folder / "labels.csv").write_text(text)
    with pytest.raises((DataError, UsageError), match=message):
        list(RGBD(str(folder), **TABLE, **SMALL))


def test_a_table_that_is_no_text(folder: Path) -> None:
    (folder / "labels.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DataError, match="cannot read the table of frames"):
        list(RGBD(str(folder), **TABLE))
    (folder / "labels.csv").unlink()
    with pytest.raises(DataError, match="No such file"):
        list(RGBD(str(folder), **TABLE))


def test_folders_without_pictures(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"no picture in .*rgb and none in .*depth"):
        list(RGBD(str(tmp_path)))


def test_convert_and_read_again(folder: Path, tmp_path: Path) -> None:
    source = RGBD(str(folder), **TABLE, **SMALL)
    out = tmp_path / "out.mcap"
    with McapWriter(out, metadata=source.metadata) as writer:
        assert copy(source, writer) == 4
    log = open_log(out)
    assert log.metadata["scan"] == "virtual, cut from 8 rows of the depth image"
    assert log.metadata["frames"] == "single frames, not a drive"
    for read, made in zip(log, source, strict=True):
        assert (read.stamp, read.label, read.pose) == (made.stamp, made.label, None)
        assert read.scan is not None
        assert made.scan is not None
        np.testing.assert_allclose(read.scan.ranges, made.scan.ranges, rtol=1e-6)
        np.testing.assert_allclose(read.scan.angles, made.scan.angles, atol=1e-5)
        np.testing.assert_array_equal(read.image, made.image)


@pytest.fixture(scope="module")
def nyu() -> dict[str, Any]:
    """Return the shipped option."""
    text = (files("placecue_conf") / "source" / "nyuv2.yaml").read_text()
    option = yaml.safe_load(text)
    assert option.pop("plugin") == "rgbd"
    return {**option, "path": f"{DATA}/nyuv2"}


@needs_data
def test_nyu_frames_are_all_read(nyu: dict[str, Any]) -> None:
    with Path(nyu["path"], "labels.csv").open() as file:
        rows = list(csv.DictReader(file))
    source = RGBD(**nyu)
    seen = [(each.stamp, each.label, each.has("image"), each.has("scan")) for each in source]
    assert seen == [(int(row["index"]) * 10**9, row["room"], True, True) for row in rows]
    assert source.count() == 504


@needs_data
def test_nyu_classes_with_enough_frames(nyu: dict[str, Any]) -> None:
    with Path(nyu["path"], "labels.csv").open() as file:
        counts = Counter(row["room"] for row in csv.DictReader(file))
    source = RGBD(**{**nyu, "min_frames": 50, "parts": ["label"]})
    kept = Counter(each.label for each in source)
    assert kept == {name: n for name, n in counts.items() if n >= 50}
    assert set(kept) == {"bedroom", "kitchen", "living_room", "dining_room"}


@needs_data
def test_nyu_scenes(nyu: dict[str, Any]) -> None:
    rooms: dict[str | None, set[str | None]] = {}
    scene_of = {}
    for each in RGBD(**{**nyu, "parts": ["label"]}):
        rooms.setdefault(each.scene, set()).add(each.label)
        scene_of[each.stamp // 10**9] = each.scene
    assert len(rooms) == 168
    assert all(len(each) == 1 for each in rooms.values())
    # The bookstore, and what lies between frames of other scenes.
    assert scene_of[83] == scene_of[118] != scene_of[124]
    # Frames one after the other: two kitchens, and one bathroom from both sides.
    assert scene_of[770] != scene_of[771] == scene_of[775] != scene_of[776]
    assert scene_of[657] != scene_of[662] == scene_of[663] != scene_of[667]


@needs_data
def test_nyu_scans_are_as_long_as_the_depth_says(nyu: dict[str, Any]) -> None:
    for number, seen in enumerate(RGBD(**{**nyu, "parts": ["scan"]})):
        if number % 25:
            continue
        scan = seen.scan
        assert scan is not None
        assert (len(scan.angles), scan.valid().mean()) == (127, 1.0)
        path = f"{DATA}/nyuv2/depth/{seen.stamp // 10**9:04d}.png"
        depth = cv2.imread(path, cv2.IMREAD_UNCHANGED) / 25.5
        # The columns next to the optical axis, and those 20 degrees to the left.
        for column, degrees in (
            (325.58, 0.0),
            (325.58 - 518.86 * math.tan(math.radians(20)), 20.0),
        ):
            near = depth[224:284, round(column) - 3 : round(column) + 4]
            beam = scan.ranges[np.abs(np.rad2deg(scan.angles) - degrees).argmin()]
            depth_of_beam = beam * math.cos(math.radians(degrees))
            assert near.min() - 0.03 <= depth_of_beam <= np.percentile(near, 20) + 0.03
