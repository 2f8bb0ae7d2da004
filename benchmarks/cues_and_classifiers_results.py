"""The folder in which benchmarks/cues_and_classifiers.py keeps what is finished."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from sklearn.metrics import recall_score

from placecue.evaluation.group_bootstrap import GroupBootstrap


class Cell(NamedTuple):
    """A place in a table: a row (a cue in a part), a test and a column (a classifier)."""

    part: str
    row: str
    test: str
    column: str


class Results:
    """One JSON file a cell and fold, with the overrides that it was made with.

    Parameters
    ----------
    folder : Path
        Is made if it is not there.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def path(self, cell: Cell, fold: int) -> Path:
        """Return the file of a cell's fold."""
        row = cell.row.replace(", ", "_").replace(" ", "_")
        return self.folder / cell.part / cell.test / row / f"{cell.column}_{fold}.json"

    def known(self, cell: Cell, fold: int, overrides: list[str]) -> bool:
        """Tell whether a fold is finished, with these very overrides."""
        path = self.path(cell, fold)
        return path.is_file() and json.loads(path.read_text())["overrides"] == overrides

    def keep(self, cell: Cell, fold: int, overrides: list[str], told: dict[str, Any]) -> None:
        """Write a finished fold; it is there whole or not at all."""
        path = self.path(cell, fold)
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(".part")
        unfinished.write_text(json.dumps({"overrides": overrides, **told}))
        unfinished.replace(path)

    def folds(self, cell: Cell, count: int) -> list[dict[str, Any]] | None:
        """Return what is told of all folds of a cell, None as long as one is not finished."""
        paths = [self.path(cell, fold) for fold in range(count)]
        if not all(path.is_file() for path in paths):
            return None
        return [json.loads(path.read_text()) for path in paths]


def recalls(folds: list[dict[str, Any]]) -> dict[str, tuple[float, int]]:
    """Return for each class the share recognised, over all held-out samples, and their number."""
    truth, predicted = (
        np.concatenate([fold[name] for fold in folds]) for name in ("truth", "predicted")
    )
    classes, counts = np.unique(truth, return_counts=True)
    each = recall_score(truth, predicted, labels=classes, average=None)
    return dict(
        zip(classes.tolist(), zip(each.tolist(), counts.tolist(), strict=True), strict=True)
    )


def balanced_accuracy(folds: list[dict[str, Any]]) -> float:
    """Return the mean of the per-class recalls over all held-out samples, percent."""
    return 100 * float(np.mean([recall for recall, _ in recalls(folds).values()]))


def standard_error(folds: list[dict[str, Any]]) -> float:
    """Return that of the balanced accuracy, percent points.

    Over scenes, by drawing them anew, where they are known; else as if samples were independent.
    """
    scenes = [scene for fold in folds for scene in fold.get("scenes", [None])]
    if None not in scenes:
        truth, predicted = ([each for f in folds for each in f[n]] for n in ("truth", "predicted"))
        return GroupBootstrap(truth, scenes, draws=1000).error(predicted)
    each = recalls(folds).values()
    return 100 * float(np.sqrt(sum(r * (1 - r) / n for r, n in each)) / len(each))


def chosen_inside(variants: list[list[dict[str, Any]]]) -> list[dict[str, Any]]:
    """Return for each fold that variant which did best inside the training samples."""
    return [max(same, key=lambda fold: fold["inner"]) for same in zip(*variants, strict=True)]
