"""How long the command line takes to answer, as whole processes.

python benchmarks/startup.py [--runs 15]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from statistics import median
from time import perf_counter

SCRIPT = str(Path(sys.executable).with_name("placecue"))
#: What is timed, and what it should stay under, s.
COMMANDS: dict[str, tuple[list[str], float | None]] = {
    "python -c pass": ([sys.executable, "-c", "pass"], None),
    "python -c 'import hydra'": ([sys.executable, "-c", "import hydra"], None),
    "placecue --help": ([SCRIPT, "--help"], 0.5),
    "placecue plugins": ([SCRIPT, "plugins"], 1.0),
    "placecue train --help": ([SCRIPT, "train", "--help"], None),
    "tab after 'placecue train cue='": (
        ["env", "COMP_LINE=placecue train cue=", SCRIPT, "-sc", "query=bash"],
        None,
    ),
}


def seconds(command: list[str], runs: int) -> list[float]:
    """Return how long each run of a command took, s, after one that warms the disk cache."""
    taken = []
    for _ in range(runs + 1):
        started = perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        taken.append(perf_counter() - started)
    return taken[1:]


def main() -> None:
    """Print the median, the fastest and the slowest run of each command beside its aim."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=15)
    runs = parser.parse_args().runs
    print(f"{'command':<34}{'median':>10}{'fastest':>10}{'slowest':>10}{'aim':>10}")
    for name, (command, aim) in COMMANDS.items():
        taken = seconds(command, runs)
        shown = [f"{value:8.3f} s" for value in (median(taken), min(taken), max(taken))]
        print(f"{name:<34}{''.join(shown)}{'' if aim is None else f'   < {aim} s'}")


if __name__ == "__main__":
    main()
