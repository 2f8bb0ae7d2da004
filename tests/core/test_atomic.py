"""Files that are whole or not there at all, whatever becomes of their process."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from placecue.atomic import checked_by, remove_dead_parts, replacing, write_text
from placecue.errors import DataError, UsageError
from placecue.logs.writing.writer import McapWriter

#: Begins a file, says so, and waits for what comes.
BEGINS = """
import sys
from pathlib import Path
{begin}
    print("begun", flush=True)
    sys.stdin.read()
"""
WRITERS = {
    "text": BEGINS.format(
        begin="from placecue.atomic import replacing\nwith replacing(Path(sys.argv[1])) as part:\n"
        "    part.write_text('half')"
    ),
    "log": BEGINS.format(
        begin="from placecue.logs.writing.writer import McapWriter\n"
        "with McapWriter(sys.argv[1]) as writer:"
    ),
}


def begun(writer: str, path: Path) -> subprocess.Popen[str]:
    """Return a process in the middle of writing a file."""
    words = [sys.executable, "-c", WRITERS[writer], str(path)]
    process = subprocess.Popen(
        words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    return process


def overwrite(path: Path, then: Callable[[], None]) -> None:
    with replacing(path) as part:
        part.write_text("new")
        then()


def fail() -> None:
    raise OSError("full")


@pytest.mark.parametrize("writer", WRITERS)
def test_what_a_killed_run_leaves_goes_with_the_next(tmp_path: Path, writer: str) -> None:
    process = begun(writer, tmp_path / "a.mcap")
    [left] = tmp_path.iterdir()
    process.kill()
    assert process.wait(timeout=60) == -signal.SIGKILL
    assert list(tmp_path.iterdir()) == [left]
    with McapWriter(tmp_path / "b.mcap"):
        pass
    assert [each.name for each in tmp_path.iterdir()] == ["b.mcap"]


@pytest.mark.parametrize("writer", WRITERS)
def test_what_a_living_run_writes_stays(tmp_path: Path, writer: str) -> None:
    process = begun(writer, tmp_path / "a.mcap")
    write_text(tmp_path / "b.txt", "whole")
    remove_dead_parts(tmp_path)
    told, complaint = process.communicate("", timeout=60)
    assert (process.returncode, told, complaint) == (0, "", "")
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.mcap", "b.txt"]


def test_what_is_being_written_in_this_process_stays(tmp_path: Path) -> None:
    with replacing(tmp_path / "a.txt") as part:
        write_text(tmp_path / "b.txt", "b")
        part.write_text("a")
    assert (tmp_path / "a.txt").read_text() == "a"


def test_files_of_others_stay(tmp_path: Path) -> None:
    others = [".hidden", ".a.part", "a.placecue.part"]
    for name in others:
        (tmp_path / name).write_text(name)
    write_text(tmp_path / "b.txt", "b")
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted([*others, "b.txt"])


def test_a_link_under_the_name_of_a_part_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "far.txt").write_text("far")
    (tmp_path / ".a.12345678.placecue.part").symlink_to(tmp_path / "far.txt")
    remove_dead_parts(tmp_path)
    assert (tmp_path / "far.txt").read_text() == "far"


def test_the_longest_name_there_is(tmp_path: Path) -> None:
    path = tmp_path / ("ü" * 127)
    assert write_text(path, "text").read_text() == "text"


def test_a_failed_block_leaves_what_was_there(tmp_path: Path) -> None:
    path = write_text(tmp_path / "a.txt", "old")
    with pytest.raises(DataError, match=f"cannot write {path}: full"):
        overwrite(path, fail)
    assert [(each.name, each.read_text()) for each in tmp_path.iterdir()] == [("a.txt", "old")]


def test_a_check_is_asked_first_and_last(tmp_path: Path) -> None:
    path, closed = tmp_path / "a.txt", []

    def check(asked: Path) -> None:
        if asked == path and closed:
            raise UsageError("not here")

    with checked_by(check):
        write_text(path, "old")
        with pytest.raises(UsageError, match="not here"):
            overwrite(path, lambda: closed.append(True))  # such as a log that is opened meanwhile
        with pytest.raises(UsageError, match="not here"):
            McapWriter(path)
    assert [(each.name, each.read_text()) for each in tmp_path.iterdir()] == [("a.txt", "old")]
    assert write_text(path, "new").read_text() == "new"
