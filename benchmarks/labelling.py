"""Labelling of space on logs that nothing was tuned on: the tables of docs/labelling.md.

    PLACECUE_DATA=data python benchmarks/labelling.py runs/labelling

Recordings are made and models trained on first use; what each accumulator makes of each log is kept
in the folder as it comes, so that a run that was stopped goes on where it was. Take another folder
after a change of the code. ``labelling_tune.py`` chose what is shipped, on the other half.
"""

from __future__ import annotations

import sys
from pathlib import Path

from labelling_data import Data
from labelling_outcomes import Outcomes
from labelling_page import ACCUMULATORS, AS_SCORED, PAGE, write
from labelling_plan import tests


def main(folder: Path) -> None:
    """Label everything, and write the page."""
    data = Data(folder)
    data.make()
    known = Outcomes(folder / "reporting.jsonl", data, whole=True)
    halves = {half: [t for t in tests() if t.half == half] for half in ("tuning", "reporting")}
    found = {}
    for words in [*ACCUMULATORS.values(), AS_SCORED]:
        for test in [*halves["reporting"], *halves["tuning"]]:
            [outcome] = known.of(words, [test])
            found[" ".join(words), test.name] = outcome
            print(" ".join(words) or "crf", test.name, outcome["way"], flush=True)
    write(PAGE, found, halves)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
