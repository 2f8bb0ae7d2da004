"""Commands killed at random moments: nothing is left half-written, and the next run gives the same.

``python benchmarks/kills.py FOLDER [KILLS] [SEED]``

Each of train, classify, label, convert and evaluate is killed (SIGKILL) KILLS times, then run to
its end. After each kill whatever has its name must be the file of an undisturbed run, byte for
byte; files that two undisturbed runs write differently (they hold times) must be whole. FOLDER
keeps what was found, so a stopped run goes on.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from io import BytesIO
from multiprocessing import get_context
from multiprocessing.process import BaseProcess
from pathlib import Path
from shutil import rmtree
from time import perf_counter
from zipfile import BadZipFile

import numpy as np

from placecue import cli
from placecue.atomic import SUFFIX, write_json
from placecue.logs.mcap.container import LogFile

FEW = ["cue=laser", "integrator=none", "cues.laser.classifier.search.gamma=[0.01,0.1]"]
#: Words after ``placecue``, but for where results go.
COMMANDS: dict[str, list[str]] = {
    "train": ["train", "a.mcap", *FEW],
    "classify": ["classify", "model", "b.mcap"],
    "label": ["label", "model", "b.mcap"],
    "convert": ["convert", "a.mcap"],
    "evaluate": ["evaluate", "a.mcap", "b.mcap", *FEW, "executor.jobs=2"],
}
#: Makes the logs.
DRIVE = ["convert", "source=office", "source.rate=1", "source.width=64", "source.height=48"]
WHOLE: dict[str, Callable[[bytes], bool]] = {
    ".html": lambda data: data.rstrip().endswith(b"</html>"),
    ".json": lambda data: bool(json.loads(data)),
    ".npz": lambda data: all(each.nbytes >= 0 for each in np.load(BytesIO(data)).values()),
    ".png": lambda data: data.endswith(b"IEND\xaeB`\x82"),
}


def command(name: str, out: Path) -> list[str]:
    """Return the words of a command that writes into a folder."""
    if name == "convert":
        return [*COMMANDS[name], str(out / "copy.mcap"), "overwrite=true"]
    again = [] if name == "evaluate" else ["overwrite=true"]
    return [*COMMANDS[name], f"out={out}", *again, f"cache.folder={out.parent / 'features'}"]


def told(words: list[str], log: Path) -> None:
    """Run a command line; its words go to a file."""
    os.setsid()
    with log.open("a") as file, redirect_stdout(file), redirect_stderr(file):
        sys.exit(cli.run(words))


def started(words: list[str], folder: Path) -> BaseProcess:
    """Start a command in a process that has imported everything."""
    process = get_context("fork").Process(target=told, args=(words, folder / "told.txt"))
    process.start()
    return process


def finished(words: list[str], folder: Path) -> float:
    """Run a command to its end and return how long that took, s."""
    began = perf_counter()
    process = started(words, folder)
    process.join()
    if process.exitcode:
        raise SystemExit(f"{' '.join(words)} ends with {process.exitcode}; see {folder}/told.txt")
    return perf_counter() - began


def files(out: Path) -> dict[str, bytes]:
    """Return what has its name in a folder, by that name."""
    found = [path for path in sorted(out.rglob("*")) if path.is_file()]
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in found
        if not path.name.endswith((SUFFIX, ".lock"))
    }


def is_whole(name: str, data: bytes, out: Path) -> bool:
    """Tell whether a file whose content may differ is complete."""
    if name.endswith(".mcap"):
        return LogFile(out / name).contents.damage is None
    try:
        return WHOLE.get(Path(name).suffix, lambda each: bool(each))(data)
    except (ValueError, OSError, EOFError, BadZipFile):
        return False


def faults(out: Path, due: dict[str, bytes], timeless: set[str]) -> list[str]:
    """Return the files that are neither those of an undisturbed run nor whole."""
    return [
        name
        for name, data in files(out).items()
        if (name in timeless and data != due[name])
        or (name not in timeless and not is_whole(name, data, out))
    ]


def kill_once(name: str, folder: Path, moment: float) -> int | None:
    """Start a command, kill it after a while and return its number; None if it had ended.

    What it started itself goes on for now, beside the next run.
    """
    process = started(command(name, folder / "out"), folder)
    process.join(moment)
    alive = process.is_alive()
    if alive:
        process.kill()
    process.join()
    return process.pid if alive else None


def end(groups: list[int]) -> None:
    """End what killed commands had started."""
    for group in groups:
        with suppress(ProcessLookupError):
            os.killpg(group, signal.SIGKILL)
    groups.clear()


def undisturbed(name: str, folder: Path) -> tuple[float, dict[str, bytes], set[str]]:
    """Return how long a command takes, what it writes, and which files are the same each time."""
    runs = []
    for each in ("one", "other"):
        rmtree(folder / "features", ignore_errors=True)
        took = finished(command(name, folder / each / "out"), folder)
        runs.append(files(folder / each / "out"))
        rmtree(folder / each)
    first, written = runs
    return took, written, {each for each, data in written.items() if first.get(each) == data}


def tried(name: str, folder: Path, kills: int, seed: int) -> dict[str, object]:
    """Kill a command so often, and return what was found."""
    rmtree(folder, ignore_errors=True)
    folder.mkdir()
    took, due, timeless = undisturbed(name, folder)
    rng = np.random.default_rng(seed)
    killed, wrong, rounds = 0, [], 0
    groups: list[int] = []
    out = folder / "out"
    while killed < kills:
        group = kill_once(name, folder, rng.uniform(0.02, took))
        wrong += faults(out, due, timeless)
        if group is not None:
            killed += 1
            groups.append(group)
            if rng.integers(2):
                end(groups)
        else:  # it came to its end, as evaluate does that goes on where it was
            end(groups)
            rmtree(out)
            rmtree(folder / "features", ignore_errors=True)
            rounds += 1
    end(groups)
    finished(command(name, out), folder)
    left = [str(path) for path in out.rglob(f".*{SUFFIX}")]
    missing = sorted(set(due) ^ set(files(out)))
    same = not missing and not left and not faults(out, due, timeless)
    return {
        "kills": killed,
        "seconds of a run": round(took, 1),
        "came to their end": rounds,
        "half-written": wrong,
        "same results after": same,
        "compared byte for byte": len(timeless),
        "with times in them": sorted(set(due) - timeless),
        "missing, or too much": missing,
        "parts left": left,
    }


def main() -> None:
    """Try what has not been tried, and print what was found."""
    folder = Path(sys.argv[1]).resolve()
    kills, seed = (int(each) for each in (*sys.argv[2:4], *("25", "12")[len(sys.argv) - 2 :]))
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(folder)
    for run, log in enumerate(("a.mcap", "b.mcap")):
        cli.run([*DRIVE, f"source.run={run + 1}", log, "overwrite=true"])
    cli.run([*COMMANDS["train"], "out=model", "overwrite=true"])
    cli.run([*COMMANDS["label"], "out=imported", "overwrite=true"])  # what it imports is forked
    for name in COMMANDS:
        found = Path(f"{name}.json")
        if not found.is_file():
            write_json(found, tried(name, folder / name, kills, seed))
        print(name, found.read_text(), flush=True)


if __name__ == "__main__":
    main()
