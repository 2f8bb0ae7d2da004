"""Peak memory and time of commands over damaged and oversized files.

``python benchmarks/damaged.py FOLDER GOOD_LOG [OUT]``

Every log, bag, tar, table of labels and file of rooms in FOLDER is given to ``info``, ``convert``
and ``label``, each in a process of its own; tables and rooms together with GOOD_LOG. No answer may
take more than 500 MB or 10 s of processor time, or be that something should not happen.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

from placecue import cli

MEMORY, SECONDS = 500, 10.0


def words_for(path: Path, good: str, out: Path) -> Iterator[list[str]]:
    """Yield the command lines that read a file."""
    if path.suffix == ".csv":
        given = [good, f"source.labels={path}"]
    elif path.suffix == ".geojson":
        given = [good, f"rooms={path}"]
    else:
        given = [str(path)]
    yield ["info", *given]
    yield ["convert", *given, str(out / "copy.mcap"), "overwrite=true"]
    yield ["label", *given, f"out={out / 'map'}", "overwrite=true", "cache.folder=null"]


def run(words: list[str], told: Path) -> tuple[int, float, float]:
    """Run a command in a process and return its status, peak memory (MB) and processor time (s)."""
    sys.stdout.flush()
    number = os.fork()
    if not number:
        with told.open("w") as file, redirect_stdout(file), redirect_stderr(file):
            os._exit(_status(words, file))
    _, status, usage = os.wait4(number, 0)
    seconds = usage.ru_utime + usage.ru_stime
    return os.waitstatus_to_exitcode(status), usage.ru_maxrss / 1024, seconds


def _status(words: list[str], file: object) -> int:
    status = cli.run(words)
    sys.stdout.flush()
    sys.stderr.flush()
    return status


def main() -> None:
    """Print a line for each file and command, and what was over."""
    folder, good = Path(sys.argv[1]), str(Path(sys.argv[2]).resolve())
    over = []
    with TemporaryDirectory() as scratch:
        out = Path(scratch)
        imports = ["label", good, f"out={out / 'first'}", "cache.folder=null"]
        with redirect_stdout(sys.stderr):
            cli.run(imports)  # what it imports is forked
        for path in sorted(each for each in folder.rglob("*") if each.is_file()):
            if path.suffix == ".md":
                continue
            for words in words_for(path, good, out):
                status, memory, seconds = run(words, out / "told.txt")
                told = (out / "told.txt").read_text().strip().splitlines()
                line = f"{path.name:<34}{words[0]:<8}{status:>4}{memory:7.0f} MB{seconds:6.1f} s"
                print(line, f"  {told[-1][:150] if told else ''}", flush=True)
                if memory > MEMORY or seconds > SECONDS or "should not happen" in str(told):
                    over.append(line)
    print(*(["over:", *over] if over else ["nothing is over"]), sep="\n")


if __name__ == "__main__":
    main()
