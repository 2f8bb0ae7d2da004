"""Folders and tars with links, hidden files, sparse and too large members; full disks."""

from __future__ import annotations

import errno
import io
import os
import tarfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from placecue.errors import DataError, UnusableObservation
from placecue.faults import Faults
from placecue.limits import limited
from placecue_sources import archive as archives
from placecue_sources.archive import open_archive
from placecue_sources.image_folder import ImageFolder
from placecue_sources.ranges import ranges_of
from placecue_sources.rgbd import RGBD
from placecue_sources.table import Table

PNG = cv2.imencode(".png", np.full((4, 4, 3), 9, np.uint8))[1].tobytes()


def put(path: Path, data: bytes = PNG) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def labels(path: Path) -> list[str | None]:
    return [each.label for each in ImageFolder(str(path))]


def test_a_linked_folder_of_a_class_is_one(tmp_path: Path) -> None:
    put(tmp_path / "d/office/1.png")
    put(tmp_path / "elsewhere/1.png")
    (tmp_path / "d/kitchen").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "d/office/loop").symlink_to(tmp_path / "d")
    (tmp_path / "d/office/self").symlink_to(tmp_path / "d/office")
    assert labels(tmp_path / "d") == ["kitchen", "office"]


def test_a_linked_folder_that_is_gone_is_counted(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    put(tmp_path / "d/office/1.png")
    (tmp_path / "d/kitchen").symlink_to(tmp_path / "elsewhere")
    assert labels(tmp_path / "d") == ["office"]
    assert "1 links lead nowhere and were left out (the first: kitchen)" in caplog.text


@pytest.mark.parametrize(
    "hidden", [".ipynb_checkpoints/1.png", "office/._1.png", "__MACOSX/o/1.png"]
)
def test_what_is_hidden_is_no_class_and_no_image(tmp_path: Path, hidden: str) -> None:
    put(tmp_path / "d/office/1.png")
    put(tmp_path / "d" / hidden)
    assert labels(tmp_path / "d") == ["office"]


def tar_of(path: Path, members: list[tuple[str, bytes, str]]) -> Path:
    """Write a tar; each member is a name, a kind and what it links to."""
    with tarfile.open(path, "w") as tar:
        for name, kind, target in members:
            info = tarfile.TarInfo(name)
            info.type, info.linkname = kind, target
            info.size = len(PNG) if kind == tarfile.REGTYPE else 0
            tar.addfile(info, io.BytesIO(PNG))
    return path


def test_links_in_a_tar_are_followed(tmp_path: Path) -> None:
    path = tar_of(
        tmp_path / "d.tar",
        [
            ("office/1.png", tarfile.REGTYPE, ""),
            ("office/2.png", tarfile.SYMTYPE, "1.png"),
            ("office/3.png", tarfile.LNKTYPE, "office/1.png"),
            ("office/4.png", tarfile.SYMTYPE, "3.png"),
            ("kitchen", tarfile.SYMTYPE, "office"),
        ],
    )
    faults = Faults("it")
    with open_archive(str(path), faults) as archive:
        names = archive.names()
        assert all(archive.read(name) == PNG for name in names)
    assert {"office/2.png", "office/3.png", "office/4.png", "kitchen/1.png"} <= set(names)
    assert not faults.counts


def test_links_that_lead_nowhere_or_round_are_counted(tmp_path: Path) -> None:
    path = tar_of(
        tmp_path / "d.tar",
        [
            ("office/1.png", tarfile.REGTYPE, ""),
            ("office/2.png", tarfile.SYMTYPE, "gone.png"),
            ("a", tarfile.SYMTYPE, "b"),
            ("b", tarfile.SYMTYPE, "a"),
        ],
    )
    faults = Faults("it")
    with open_archive(str(path), faults) as archive:
        assert archive.names() == ["office/1.png"]
    assert faults.counts == {"links in the tar lead nowhere and were left out": 3}


def test_a_file_larger_than_the_limit_is_not_read(tmp_path: Path) -> None:
    tar = tar_of(tmp_path / "d.tar", [("office/1.png", tarfile.REGTYPE, "")])
    put(tmp_path / "d/office/1.png")
    with limited({"file": len(PNG) - 1}):
        for path in (tar, tmp_path / "d"):
            with (
                open_archive(str(path), Faults("it")) as archive,
                pytest.raises(UnusableObservation, match=r"more than limits\.file="),
            ):
                archive.read("office/1.png")


def test_a_sparse_file_counts_by_what_it_would_be(tmp_path: Path) -> None:
    put(tmp_path / "d/office/1.png")
    with (tmp_path / "d/office/1.png").open("r+b") as file:
        file.truncate(2**40)
    with (
        open_archive(str(tmp_path / "d"), Faults("it")) as archive,
        pytest.raises(UnusableObservation, match=f"has {2**40} bytes, more than"),
    ):
        archive.read("office/1.png")


def test_more_files_than_the_limit_are_refused(tmp_path: Path) -> None:
    members = [(f"office/{n}.png", tarfile.REGTYPE, "") for n in range(3)]
    tar_of(tmp_path / "d.tar", members)
    put(tmp_path / "d/office/1.png")
    put(tmp_path / "d/office/2.png")
    with limited({"members": 1}), pytest.raises(DataError, match=r"more than limits\.members=1"):
        labels(tmp_path / "d")
    with limited({"members": 1}), pytest.raises(DataError, match=r"more than limits\.members=1"):
        labels(tmp_path / "d.tar")


def test_no_room_to_unpack_is_no_damage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "d.tar.gz"
    with tarfile.open(path, "w:gz") as tar:
        info = tarfile.TarInfo("office/1.png")
        info.size = len(PNG)
        tar.addfile(info, io.BytesIO(PNG))

    class Full(io.BytesIO):
        def write(self, data: Any, /) -> int:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(archives.tempfile, "TemporaryFile", Full)
    with pytest.raises(DataError, match=r"no room to unpack the tar in .*TMPDIR"):
        labels(path)


@pytest.mark.parametrize("text", ["1,5 2,5 3,5", "1,5;2,5", "1.5 2.5, 3.5", "1,5\n2,5", "1 2;3"])
def test_numbers_separated_in_two_ways_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="separate them in one way"):
        ranges_of(text)


@pytest.mark.parametrize("text", ["1.5 2.5", "1.5, 2.5", "1.5 ,2.5", "[1.5; 2.5]", "1.5\n2.5\n"])
def test_numbers_separated_in_one_way_are_read(text: str) -> None:
    assert ranges_of(text).tolist() == [1.5, 2.5]


def test_a_byte_order_mark_is_no_fault(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "t.csv").write_text("\ufeffstamp,x,y\n1,2,3\n", "utf-8")
    (observation,) = Table(str(tmp_path / "t.csv"))
    assert observation.stamp == 1_000_000_000
    assert not caplog.records


@pytest.mark.parametrize("unit", ["s", "ns"])
def test_a_time_of_a_million_digits_is_refused_at_once(tmp_path: Path, unit: str) -> None:
    (tmp_path / "t.csv").write_text("stamp,x,y\n1,2,3\n1e900000,2,3\n")
    (observation,) = Table(str(tmp_path / "t.csv"), stamp_unit=unit)
    assert observation.pose is not None


def rgbd(folder: Path, images: list[str], depths: list[str]) -> RGBD:
    depth = cv2.imencode(".png", np.full((96, 128), 10_000, np.uint16))[1].tobytes()
    for name in images:
        put(folder / "rgb" / f"{name}.png")
    for name in depths:
        put(folder / "depth" / f"{name}.png", depth)
    return RGBD(str(folder), fx=120.0, cx=64.0, cy=48.0, depth_scale=0.0002)


def test_times_of_colour_and_depth_are_paired_by_the_nearest(tmp_path: Path) -> None:
    images = ["10.0150", "10.0483", "10.0816", "10.5000"]
    depths = ["10.0000", "10.0333", "10.0666", "10.9000"]
    found = list(rgbd(tmp_path, images, depths))
    assert [(each.stamp, each.has("image"), each.has("scan")) for each in found] == [
        (10_015_000_000, True, True),
        (10_048_300_000, True, True),
        (10_081_600_000, True, True),
        (10_500_000_000, True, False),
        (10_900_000_000, False, True),
    ]


def test_times_that_are_never_near_are_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"no depth image lies within 0\.02 s"):
        list(rgbd(tmp_path, ["10.0", "10.1"], ["20.0", "20.1"]))
