"""Paths that stand by themselves, and formats told by content."""

from __future__ import annotations

import gzip
import shutil
import tarfile
from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import placecue, succeeds
from placecue.commands.words import in_keys, logs_in
from placecue.components.formats import source_of
from placecue.components.manager import load_plugins
from placecue.errors import UsageError

REGISTRY = load_plugins(built_ins_only=True).registry
CARMEN = "# CARMEN Logfile\nFLASER 2 1.0 2.0 0 0 0 0 0 0 10.25 host 1\n"


def picture(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.zeros((4, 4, 3), np.uint8))


@pytest.mark.parametrize(
    ("command", "words", "expected"),
    [
        ("train", ["a.mcap", "out=m"], ["log=a.mcap", "out=m"]),
        ("train", ["out=m", "a.mcap", "b.mcap"], ["log=[a.mcap,b.mcap]", "out=m"]),
        ("train", ["-m", "a.mcap", "cue=a,b"], ["log=a.mcap", "-m", "cue=a,b"]),
        ("train", ["a b.mcap"], ["log='a b.mcap'"]),
        ("train", ["it's.mcap"], [r"log='it\'s.mcap'"]),
        ("train", ["2024.5"], ["log='2024.5'"]),
        ("convert", ["a.bag", "o.mcap"], ["out=o.mcap", "log=a.bag"]),
        ("convert", ["a.bag", "b.bag", "o.mcap"], ["out=o.mcap", "log=[a.bag,b.bag]"]),
        ("convert", ["a.bag", "out=o.mcap"], ["log=a.bag", "out=o.mcap"]),
        ("convert", ["source=office", "o.mcap"], ["out=o.mcap", "source=office"]),
        ("report", ["runs/x"], ["out=runs/x"]),
        ("where", ["labelled", "x=1", "y=2"], ["map='labelled'", "x=1", "y=2"]),
        ("info", ["a.mcap", "--cfg", "job"], ["log=a.mcap", "--cfg", "job"]),
        ("info", ["a.mcap", "--json"], ["log=a.mcap", "json=true"]),
    ],
)
def test_words_get_their_keys(
    command: str, words: list[str], expected: list[str], tmp_path: Path
) -> None:
    for name in ("a.mcap", "b.mcap", "a b.mcap", "it's.mcap", "2024.5", "a.bag", "b.bag"):
        (tmp_path / name).touch()
    assert in_keys(command, words) == expected


@pytest.mark.parametrize(
    ("command", "words", "said"),
    [
        ("train", ["a.mcap", "log=b.mcap"], "a.mcap stands beside log=, which says the same"),
        ("cache", ["a.mcap"], "cache takes no paths"),
        ("info", ["nothing"], "'nothing' is neither key=value nor a file that is there"),
    ],
)
def test_words_that_cannot_be(command: str, words: list[str], said: str, tmp_path: Path) -> None:
    (tmp_path / "a.mcap").touch()
    with pytest.raises(UsageError, match=said):
        in_keys(command, words)


def test_logs_of_a_list_and_of_a_sweep() -> None:
    assert logs_in(["log=['a b',c]"]) == [Path("a b"), Path("c")]
    assert logs_in(["x=1", "log=a,b"]) == [Path("a"), Path("b")]
    assert logs_in(["log=null"]) == []


def make(kind: str, folder: Path) -> Path:
    """Make a small example of a format, under a name that does not tell."""
    path = folder / "thing"
    if kind == "carmen":
        path.write_text(CARMEN)
    elif kind == "carmen.gz":
        path.write_bytes(gzip.compress(CARMEN.encode()))
    elif kind == "table":
        path = folder / "thing.csv"
        path.write_text("stamp,image,label\n1,a.png,x\n")
    elif kind in ("image_folder", "image_tar"):
        picture(path / "office" / "1.png")
    elif kind in ("idol2", "idol2_tar"):
        picture(path / "t1.5_rBO_x0.1_y0.2_a0.3.png")
    elif kind == "cold":
        picture(path / "std_cam" / "t1.5_x0.1_y0.2_a0.3.jpeg")
    elif kind == "cold_meta":
        path.mkdir()
        for name in ("scans.dat", "labels.dat"):
            (path / name).touch()
    elif kind == "rgbd":
        picture(path / "rgb" / "1.png")
        picture(path / "depth" / "1.png")
    if kind.endswith("_tar"):
        with tarfile.open(folder / "packed", "w") as archive:
            archive.add(path, "thing")
        return folder / "packed"
    return path


@pytest.mark.parametrize(
    ("kind", "source"),
    [
        ("carmen", "carmen"),
        ("carmen.gz", "carmen"),
        ("table", "table"),
        ("image_folder", "image_folder"),
        ("image_tar", "image_folder"),
        ("idol2", "idol2"),
        ("idol2_tar", "idol2"),
        ("cold", "cold"),
        ("cold_meta", "cold_meta"),
        ("rgbd", "rgbd"),
    ],
)
def test_formats_are_told_by_content(kind: str, source: str, tmp_path: Path) -> None:
    assert source_of(make(kind, tmp_path), REGISTRY) == source


def test_what_is_nothing_is_told_with_what_was_looked_for(tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("hello\n")
    told = placecue("info", str(path))
    assert told.status == 2
    assert "notes.txt is nothing that placecue knows (a file that begins with b'hello" in told.line
    for name in ("mcap", "rosbag", "carmen", "table", "image_folder", "idol2", "cold"):
        assert f"{name}: " in told.line


def test_a_log_under_another_name(log_a: Path, tmp_path: Path) -> None:
    copy = tmp_path / "recording"
    shutil.copy(log_a, copy)
    assert "96 observations" in succeeds("info", str(copy)).out


def test_info_of_a_carmen_log(tmp_path: Path) -> None:
    path = make("carmen", tmp_path)
    told = succeeds("info", str(path)).out
    assert "1 observations, 0.0 % with a label" in told
    assert [line.split() for line in told.splitlines() if line.startswith("scan")] == [
        ["scan", "1"]
    ]


def test_formats_that_are_mixed(log_a: Path, tmp_path: Path) -> None:
    told = placecue("train", str(log_a), str(make("carmen", tmp_path)))
    assert told.status == 2
    assert "logs of several formats" in told.line
