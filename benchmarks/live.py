"""Latency of placecue live at 30 Hz: from the arrival of an image to what is believed of it.

    python benchmarks/live.py FOLDER [METHOD ...] [--workers 1 2] [--seconds 50]

A drive through the simulated office, 30 images and scans a second, is sent by a process of its own
(benchmarks/live_robot.py) to ``placecue live``, as a robot would. Logs and models are made in
FOLDER where they are not there yet; figures are added to FOLDER/live.json as they come, and those
that are there are not measured again. The table of docs/live.md is made of them.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

from tables import put, table

PAGE = Path(__file__).parents[1] / "docs" / "live.md"
PLACECUE = [str(Path(sys.executable).with_name("placecue"))]
ROBOT = [sys.executable, str(Path(__file__).with_name("live_robot.py"))]
#: Cues and integrator of each method.
METHODS = {
    "laser": ("laser", "none"),
    "crfh_laser": ("[crfh,laser]", "svm_das"),
    "confidence": ("[crfh,laser]", "confidence"),
    "sift": ("[crfh,sift,laser]", "svm_das"),
    "lite0": ("[crfh,lite0,laser]", "svm_das"),
}
DRIVES = {
    "train": ("source.rate=10",),
    "drive": ("source.run=3", "source.rate=30", "source.samples=1800"),
}
FIGURES = re.compile(
    r"(?P<seen>\d+) observations; dropped.*: (?P<dropped>\d+) observations.*\n"
    r"latency.*median (?P<median>[\d.]+) ms, 99th percentile (?P<late>[\d.]+) ms"
)
ROUND = 50


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("folder", type=Path)
    options.add_argument("methods", nargs="*", default=list(METHODS))
    options.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    options.add_argument("--seconds", type=float, default=ROUND)
    given = options.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    kept = given.folder / "live.json"
    found = json.loads(kept.read_text()) if kept.exists() else {}
    for name, words in DRIVES.items():
        log = given.folder / f"{name}.mcap"
        if not log.exists():
            _placecue("convert", "source=office", *words, f"out={log}")
    for method in given.methods:
        _train(given.folder, method)
        for workers in given.workers:
            key = f"{method} {workers}"
            if key not in found:
                found[key] = _measured(given.folder, method, workers, given.seconds)
                kept.write_text(json.dumps(found, indent=1))
    put(PAGE, {"pace": _table(found)})


def _train(folder: Path, method: str) -> None:
    model = folder / method
    if not (model / "manifest.json").exists():
        cues, integrator = METHODS[method]
        words = [f"cue={cues}", f"integrator={integrator}", "report=false"]
        _placecue("train", f"log={folder / 'train.mcap'}", *words, f"out={model}")


def _measured(folder: Path, method: str, workers: int, seconds: float) -> dict[str, float]:
    with _robot(folder / "drive.mcap") as address:
        words = [f"workers={workers}", f"seconds={seconds}", "port=0", "overwrite=true"]
        told = _placecue(
            *("live", address, f"model={folder / method}", f"out={folder / 'live'}", *words)
        )
    figures = FIGURES.search(told)
    assert figures, told
    scores = json.loads((folder / "live" / "metrics.json").read_text())
    return {
        **{name: float(value) for name, value in figures.groupdict().items()},
        "balanced_accuracy": scores["methods"]["integrated"]["balanced_accuracy"],
    }


@contextmanager
def _robot(log: Path):
    words = [*ROBOT, str(log), "--port", "0"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as robot:
        try:
            yield robot.stdout.readline().strip()
        finally:
            robot.kill()


def _placecue(*words: str) -> str:
    print("placecue", *words, file=sys.stderr, flush=True)
    return subprocess.run([*PLACECUE, *words], stdout=subprocess.PIPE, text=True, check=True).stdout


def _table(found: dict[str, dict[str, float]]) -> str:
    heads = ["cues, integrator", "threads", "median, ms", "99th percentile, ms", "dropped", "right"]
    rows = []
    for key, row in found.items():
        method, workers = key.rsplit(" ", 1)
        cues, integrator = METHODS[method]
        dropped = 100 * row["dropped"] / (row["seen"] + row["dropped"])
        rows.append([
            f"{cues.strip('[]').replace(',', ' + ')}, {integrator}",
            workers,
            f"{row['median']:.1f}",
            f"{row['late']:.1f}",
            f"{dropped:.1f} %",
            f"{100 * row['balanced_accuracy']:.1f} %",
        ])  # fmt: skip
    return table(heads, rows)


if __name__ == "__main__":
    main()
