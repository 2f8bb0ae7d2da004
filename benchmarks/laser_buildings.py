"""The laser cue in a building never seen before: the second part of docs/laser.md.

    PLACECUE_DATA=data python benchmarks/laser_buildings.py runs/laser_buildings

Scans are ray-cast in six labelled floor plans, 100 of each class in each, at random poses at least
0.3 m from walls, 720 beams over 360 degrees, 1 cm of noise. Each building is held out in turn; an
SVM picks C and gamma by holding out one of the others in turn. Features and results are kept in
the folder as they come; take another folder after a change of the code. At the end the tables are
written into the page.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from cues_and_classifiers import REGISTRY, components, config_of
from cues_and_classifiers_plan import BUILDINGS, PARTS, SKLEARN
from cues_and_classifiers_results import Results
from laser_buildings_page import TESTS, cell, write

from placecue import Cue
from placecue.classifier import Classifier
from placecue.components.build import build
from placecue.features import take
from placecue.training_set import TrainingSet
from placecue_classifiers.svm import SVM

PAGE = Path(__file__).parents[1] / "docs" / "laser.md"
SOURCE = PARTS["maps_360"].source
CUE = ["cue=[laser]", "integrator=none", "cues.laser.preset=full", "cues.laser.scales=[0.8,1,1.25]"]
PLACE = "cues.laser.classifier"
BY_LOG = f"{PLACE}.folds={{plugin:by_log,n_folds:{len(BUILDINGS) - 1}}}"
QUANTILES = f"{PLACE}.scaling=quantiles"
PLAIN = [BY_LOG, QUANTILES, f"{PLACE}.search.gamma=[0.0003,0.001,0.003,0.01,0.03,0.1]"]
BOOSTED = [f"classifier@{PLACE}=adaboost", f"{PLACE}.rounds=300"]
FAMILIES = f"scaling@{PLACE}.scaling=families"


def _sklearn(name: str, scaling: str) -> list[str]:
    estimator, params = SKLEARN[name]
    chosen = [f"{PLACE}.estimator={estimator}", f"++{PLACE}.params={params}"]
    return [f"classifier@{PLACE}=sklearn", *chosen, scaling]


#: Overrides of the shipped options, and whether training also sees the scaled scans.
METHODS: Mapping[str, tuple[Sequence[str], bool]] = {
    "SVM, plain quantiles": (PLAIN, False),
    "SVM, family weights": ([BY_LOG], False),
    "SVM, plain quantiles, scales": (PLAIN, True),
    "SVM, family weights, scales": ([BY_LOG], True),
    "logistic regression, plain quantiles": (_sklearn("logistic", QUANTILES), False),
    "logistic regression, family weights": (_sklearn("logistic", FAMILIES), False),
    "5 neighbours, plain quantiles": (_sklearn("knn", QUANTILES), False),
    "5 neighbours, family weights": (_sklearn("knn", FAMILIES), False),
    "AdaBoost, 300 rounds": (BOOSTED, False),
    "AdaBoost, 300 rounds, scales": (BOOSTED, True),
}


def all_samples(folder: Path, maps: Path) -> TrainingSet:
    """Return the samples of all buildings, which are the groups, with their scaled copies."""
    config = config_of([*SOURCE, *CUE])
    cue, path = components(config)[0], folder / "features.npz"
    if not path.is_file():
        _extract(path, maps, config["source"], cue)
    with np.load(path) as kept:
        views, labels, groups = kept["views"], kept["labels"], kept["groups"]
    copies = tuple(views[1:])
    return TrainingSet(views[0], labels, None, groups, copies, families=tuple(cue.families or ()))


def _extract(path: Path, maps: Path, source: dict[str, Any], cue: Cue) -> None:
    plans = [{**source, "path": str(maps / f"{name}.png")} for name in BUILDINGS]
    scans = [list(build(plan, "source", REGISTRY)) for plan in plans]
    flat = [scan for of_plan in scans for scan in of_plan]
    copies = [cue.transform(map(augment, flat)) for augment in cue.augmentations()]
    groups = np.repeat(np.arange(len(scans)), [len(of_plan) for of_plan in scans])
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(".part.npz")
    views = np.stack([cue.transform(flat), *copies])
    np.savez(unfinished, views=views, labels=[each.label for each in flat], groups=groups)
    unfinished.replace(path)


def trained(classifier: Classifier, samples: TrainingSet, scales: bool) -> Classifier:
    """Train; C and gamma are picked without scaled copies, which three times as many would cost."""
    plain = replace(samples, augmented=())
    if scales and isinstance(classifier, SVM):
        classifier = classifier.train(plain).best()
    return classifier.train(samples if scales else plain)


def run(name: str, test: str, samples: TrainingSet, results: Results) -> None:
    """Run the buildings that are missing of a method and test."""
    overrides, scales = METHODS[name]
    overrides = [*CUE, *overrides]
    kept = samples.take(np.flatnonzero(np.isin(samples.labels, TESTS[test])))
    for number, building in enumerate(BUILDINGS):
        if results.known(cell(name, test), number, overrides):
            continue
        held_out = np.flatnonzero(kept.groups == number)
        rest = replace(kept.take(np.flatnonzero(kept.groups != number)), part=False)
        classifier = trained(components(config_of(overrides))[1], rest, scales)
        decided = classifier.scores(take(kept.features, held_out)).decide().labels
        truth, predicted = kept.labels[held_out].tolist(), np.asarray(decided).tolist()
        told = {"truth": truth, "predicted": predicted}
        results.keep(cell(name, test), number, overrides, told)
        print(name, test, building, flush=True)


def main() -> None:
    """Run what is missing, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where features and results are kept")
    parser.add_argument("--methods", nargs="*", choices=METHODS, default=list(METHODS))
    parser.add_argument("--page", type=Path, default=PAGE)
    given = parser.parse_args()
    if "PLACECUE_DATA" not in os.environ:
        raise SystemExit("PLACECUE_DATA is not set: it names the folder of recorded data")
    results = Results(given.folder)
    samples = all_samples(given.folder, Path(os.environ["PLACECUE_DATA"]) / "maps")
    for name in given.methods:
        for test in TESTS:
            run(name, test, samples, results)
    write(given.page, results, list(METHODS))


if __name__ == "__main__":
    main()
