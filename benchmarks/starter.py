"""How good the starter is in buildings it has nothing to do with: the table of docs/starter.md.

    PLACECUE_DATA=data python benchmarks/starter.py

Scans are ray-cast in the six labelled plans that have rooms, hallways and doorways, 100 of
each class in each, with 1 cm of noise. Nothing was chosen by these numbers.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from tables import put, table

from placecue.components.build import build
from placecue.components.manager import load_plugins
from placecue.starter.pipeline import InTerms, Starter
from placecue.starter.places import CORRIDOR, DOORWAY, ROOM, Places

BUILDINGS = ("Fr101", "Fr52", "intel", "lab_d_furniture", "lab_ipa", "office_e")
PAGE = Path(__file__).parents[1] / "docs" / "starter.md"
REGISTRY = load_plugins(built_ins_only=True).registry
SCANNERS = {360: 720, 270: 541, 180: 361}
TESTS = {"three": (CORRIDOR, DOORWAY, ROOM), "two": (CORRIDOR, ROOM)}
#: Truth and answer of every scan.
Told = tuple[NDArray[np.str_], NDArray[np.str_]]


def told(building: str, degrees: int, classes: Sequence[str]) -> Told:
    """Return truth and answers in a building, of scans of some classes."""
    source = {
        "plugin": "floorplan",
        "path": str(Path(os.environ["PLACECUE_DATA"]) / "maps" / f"{building}.png"),
        "balance": "class",
        "samples": 300,
        "field_of_view": degrees,
        "beams": SCANNERS[degrees],
    }
    pipeline = Starter(REGISTRY).pipeline(list(classes), laser=True, image=False)
    log = InTerms(build(source, "source", REGISTRY), Places(pipeline.classes))
    ours = [each for each in log if each.label in classes]
    answers = [belief.label for belief in pipeline.beliefs(ours, batch=16)]
    return np.array([each.label for each in ours]), np.array(answers)


def recalls(truth: NDArray[np.str_], answers: NDArray[np.str_]) -> dict[str, float]:
    """Return the share of each class that is recognised, %."""
    return {name: 100 * float((answers[truth == name] == name).mean()) for name in np.unique(truth)}


def row(degrees: int, test: str) -> list[str]:
    """Return a row of the table: all scans, each building, each class."""
    each = {building: told(building, degrees, TESTS[test]) for building in BUILDINGS}
    truth, answers = (np.concatenate(parts) for parts in zip(*each.values(), strict=True))
    every = recalls(truth, answers)
    cells = [f"{np.mean(list(every.values())):.1f}"]
    cells += [f"{np.mean(list(recalls(*pair).values())):.0f}" for pair in each.values()]
    cells += [f"{every[name]:.0f}" if name in every else "" for name in TESTS["three"]]
    return [f"{degrees}°", test, *cells]


def main() -> None:
    """Write the table into the page."""
    if "PLACECUE_DATA" not in os.environ:
        sys.exit("PLACECUE_DATA is not set: it names the folder of recorded data")
    head = ["field of view", "classes", "all", *BUILDINGS, *TESTS["three"]]
    rows = [row(degrees, test) for degrees in SCANNERS for test in TESTS]
    made = table(head, rows)
    print(made)
    put(PAGE, {"score": made})


if __name__ == "__main__":
    main()
