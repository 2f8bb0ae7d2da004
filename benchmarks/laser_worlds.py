"""The laser cue along IDOL2's recorded drives: Experiments 1 to 4 of the paper on simulated scans.

    PLACECUE_DATA=data python benchmarks/laser_worlds.py runs/laser_worlds

Pronobis et al., IJRR 29(2-3), 2010: train on one of twelve recordings, test on another; 72 ordered
pairs. Scans are ray-cast in IDOL2's floor plan at the recorded poses, with things put about
(laser_worlds_floor.py), a world a seed. Classifiers are those of the shipped options; an SVM picks
C and gamma by cross-validation in its training recording. Features and results are kept in the
folder as they come, so that a run that was stopped goes on where it was; take another folder after
a change of the code. At the end the tables are written into the page.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from cues_and_classifiers import components, config_of
from cues_and_classifiers_results import Results
from laser_worlds_data import RECORDINGS, Data, Recording
from laser_worlds_page import cell, write
from sklearn.metrics import recall_score

from placecue.training_set import TrainingSet

PAGE = Path(__file__).parents[1] / "docs" / "laser.md"
CUE = "cues.laser"
SVM = f"{CUE}.classifier"
#: Distances over 182 features are larger than over their families.
PLAIN = [f"{SVM}.scaling=quantiles", f"{SVM}.search.gamma=[0.0003,0.001,0.003,0.01,0.03,0.1]"]
ADABOOST = [f"classifier@{SVM}=adaboost"]
FULL = [f"{CUE}.preset=full"]
#: Overrides of the shipped options, as after ``placecue train``.
METHODS: Mapping[str, Sequence[str]] = {
    "L-SVM, group, plain quantiles": [f"{SVM}.multiclass=oao", *PLAIN],
    "L-SVM, group, family weights": [f"{SVM}.multiclass=oao"],
    "L-SVM, full, plain quantiles": [f"{SVM}.multiclass=oao", *PLAIN, *FULL],
    "L-SVM, full, family weights": [f"{SVM}.multiclass=oao", *FULL],
    "L-AB, group": ADABOOST,
    "L-AB, full": [*ADABOOST, *FULL],
}


def outcome(
    overrides: Sequence[str], train: Recording, of: Mapping[str, TrainingSet]
) -> dict[str, Any]:
    """Train on one recording; return what was chosen, and the recalls in each of its tests."""
    _, classifier = components(config_of(overrides))
    classifier.train(of[train.name])
    tests = []
    for experiment, test in train.tests():
        labels, features = of[test.name].labels, of[test.name].features
        decided = classifier.scores(features).decide().labels
        classes = np.unique(labels)
        recalls = recall_score(labels, decided, labels=classes, average=None)
        of_class = dict(zip(classes.tolist(), recalls.tolist(), strict=True))
        tests.append({"experiment": experiment, "test": test.name, "recalls": of_class})
    return {"chosen": getattr(classifier, "chosen_", {}), "tests": tests}


def run(world: int, name: str, data: Data, results: Results) -> None:
    """Run what is missing of a method in a world."""
    overrides = ["cue=[laser]", "integrator=none", *METHODS[name]]
    cells = {each: cell(world, name, each) for each in RECORDINGS}
    missing = [each for each in RECORDINGS if not results.known(cells[each], 0, overrides)]
    if not missing:
        return
    cue, _ = components(config_of(overrides))
    samples = data.samples(world, cue.get_params()["preset"], cue)
    for recording in missing:
        start = perf_counter()
        told = outcome(overrides, recording, samples)
        told["seconds"] = round(perf_counter() - start, 1)
        results.keep(cells[recording], 0, overrides, told)
        print(world, name, recording.name, told["chosen"], f"{told['seconds']} s", flush=True)


def main() -> None:
    """Run what is missing, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where features and results are kept")
    parser.add_argument("--worlds", type=int, nargs="*", default=[0, 1, 2, 3, 4], metavar="SEED")
    parser.add_argument("--methods", nargs="*", choices=METHODS, default=list(METHODS))
    parser.add_argument("--page", type=Path, default=PAGE)
    given = parser.parse_args()
    if "PLACECUE_DATA" not in os.environ:
        raise SystemExit("PLACECUE_DATA is not set: it names the folder of recorded data")
    data = Data(Path(os.environ["PLACECUE_DATA"]) / "idol2", given.folder / "features")
    results = Results(given.folder)
    for world in given.worlds:
        for name in given.methods:
            run(world, name, data, results)
    write(given.page, results, given.worlds, list(METHODS))


if __name__ == "__main__":
    main()
