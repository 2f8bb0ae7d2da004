"""Every cue with every classifier on recorded data: the tables of docs/cues_and_classifiers.md.

    python benchmarks/cues_and_classifiers.py runs/cues_and_classifiers

Nested cross-validation: parameters are searched inside the training samples of each outer fold,
and nothing is chosen on the fold that is scored. Each finished fold is kept in the folder, so that
a run that was stopped goes on where it was; take another folder after a change of the code. At the
end the tables are written into the page.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from cues_and_classifiers_fold import Fold, Grams
from cues_and_classifiers_page import write
from cues_and_classifiers_plan import EXTENSIONS, PARTS, ROWS, TRIED, Part, Row
from cues_and_classifiers_results import Cell, Results
from hydra import compose, initialize_config_module
from numpy.typing import NDArray
from sklearn.base import clone

from placecue import Cue, Observation
from placecue.classifier import Classifier
from placecue.components.build import build, plain
from placecue.components.manager import load_plugins
from placecue.components.options import register_with_hydra
from placecue.components.pipelines import build_pipeline
from placecue.errors import PlacecueError
from placecue.folds import FoldScheme, Rows, cut
from placecue.learning.families import families_of
from placecue.learning.grouping import groups_of
from placecue.training_set import TrainingSet

PAGE = Path(__file__).parents[1] / "docs" / "cues_and_classifiers.md"
REGISTRY = load_plugins(built_ins_only=True).registry
Config = dict[str, Any]


def config_of(overrides: Sequence[str]) -> Config:
    """Return the source and the cue with its classifier that ``placecue train`` would take."""
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = plain(compose("train", [*overrides, "log=here"]))
    return {name: config[name] for name in ("source", "cues")}


def components(config: Config) -> tuple[Cue, Classifier]:
    """Build the only cue of a config, and its classifier."""
    model = next(iter(build_pipeline(config, REGISTRY).cues.values()))
    return model.cue, model.classifier


class Log:
    """The labelled observations of one part, read once.

    Parameters
    ----------
    part : Part
    config : dict
        The source's.
    data : Path
        The folder of recorded data.
    """

    def __init__(self, part: Part, config: Config, data: Path) -> None:
        sources = [{**config, "path": str(data / path)} for path in part.paths]
        self.observations: list[Observation] = [
            each for source in sources for each in build(source, "source", REGISTRY)
        ]
        self.labels = np.array([each.label for each in self.observations])
        self.stamps = np.array([each.stamp for each in self.observations])
        origins, scenes = zip(*((o.origin, o.scene) for o in self.observations), strict=True)
        self.groups = groups_of(origins, scenes)

    def cut(self, scheme: FoldScheme, rows: Rows) -> list[tuple[Rows, Rows]]:
        """Return (training rows, held-out rows) of each fold of the given rows."""
        return cut(scheme, self.labels[rows], self.stamps[rows], self._groups(rows))

    def scenes(self, rows: Rows) -> list[str | None]:
        """Return the scenes of observations."""
        return [self.observations[row].scene for row in rows]

    def _groups(self, rows: Rows) -> NDArray[np.int64] | None:
        return None if self.groups is None else self.groups[rows]

    def fresh(self, rows: Iterable[int]) -> Iterator[Observation]:
        """Yield copies of observations, so that decoded images are not kept."""
        return (self.observations[row].relabelled(self.observations[row].label) for row in rows)

    def samples(self, cue: Cue, rows: Sequence[int]) -> TrainingSet:
        """Return the features of observations, and of their augmented copies for training."""
        copies = [cue.transform(map(augment, self.fresh(rows))) for augment in cue.augmentations()]
        recorded = cue.transform(self.fresh(rows))
        which = np.asarray(rows)
        about = self.labels[which], self.stamps[which], self._groups(which)
        families = families_of(cue, recorded)
        return TrainingSet(recorded, *about, augmented=tuple(copies), families=families)


class LearnedFeatures:
    """The features of some observations by copies of a cue that learns; remembers each.

    Parameters
    ----------
    log : Log
    cue : Cue
    rows : ndarray of int64, shape (n,)
        The observations.
    """

    def __init__(self, log: Log, cue: Cue, rows: Rows) -> None:
        self.log, self.cue, self.rows = log, cue, rows
        self.known: dict[bytes, TrainingSet] = {}

    def __call__(self, learned_from: Rows) -> TrainingSet:
        """Return the features by a copy that has learned from the given ones of the rows."""
        key = learned_from.tobytes()
        if key not in self.known:
            copy: Cue = clone(self.cue).fit(self.log.fresh(self.rows[learned_from]))
            self.known[key] = replace(self.log.samples(copy, self.rows), relearn=self)
        return self.known[key]


class Bench:
    """Runs what is missing of the rows.

    Parameters
    ----------
    results : Results
        What is finished.
    data : Path
        The folder of recorded data.
    """

    def __init__(self, results: Results, data: Path) -> None:
        self.results = results
        self.data = data
        self.log: tuple[tuple[str, Config], Log] | None = None

    def run(self, row: Row, tests: Sequence[str], columns: Sequence[str]) -> None:
        """Run those of the given tests and columns that a row has."""
        self.samples: TrainingSet | None = None
        self.grams: dict[str, Grams] = {}
        for test, of_test in row.columns.items():
            if test not in tests:
                continue
            cells = {
                Cell(row.part, row.name, test, name): row.overrides(name)
                for name in of_test
                if name in columns
            }
            for number in range(PARTS[row.part].outer):
                known = self.results.known
                missing = {c: o for c, o in cells.items() if not known(c, number, o)}
                if missing:
                    self._fold(row, test, number, missing)

    def _fold(self, row: Row, test: str, number: int, missing: dict[Cell, list[str]]) -> None:
        """Run the given cells of one outer fold."""
        fold, truth, scenes = self._samples(row, test, number)
        for cell, overrides in missing.items():
            start = perf_counter()
            told: dict[str, Any] = {"truth": truth.tolist(), "scenes": scenes}
            try:
                told |= fold.outcome(components(config_of(overrides))[1], cell.column)
            except PlacecueError as error:
                told["error"] = str(error)
            told["seconds"] = round(perf_counter() - start, 2)
            self.results.keep(cell, number, overrides, told)
            print(*cell, number, f"{told['seconds']} s", told.get("error", ""), flush=True)

    def _samples(
        self, row: Row, test: str, number: int
    ) -> tuple[Fold, NDArray[np.str_], list[str | None]]:
        """Return the samples of an outer fold, and the classes and scenes of those held out."""
        config = config_of(row.overrides(EXTENSIONS[0]))
        part, log = PARTS[row.part], self._log(row.part, config["source"])
        classes = part.tests[test]
        rows = np.flatnonzero([classes is None or label in classes for label in log.labels])
        outer = {"plugin": part.scheme, "n_folds": part.outer}
        scheme: FoldScheme = build(outer, "folds", REGISTRY)
        training, held_out = log.cut(scheme, rows)[number]
        cue, truth = components(config)[0], log.labels[rows[held_out]]
        if cue.learns:
            fold = Fold(LearnedFeatures(log, cue, rows)(training), training, held_out, {})
        else:
            if self.samples is None:
                self.samples = log.samples(cue, range(len(log.labels)))
            fold = Fold(self.samples, rows[training], rows[held_out], self.grams)
        return fold, truth, log.scenes(rows[held_out])

    def _log(self, part: str, config: Config) -> Log:
        """Return the log of a part and its source's config, the last one from memory."""
        if self.log is None or self.log[0] != (part, config):
            self.log = (part, config), Log(PARTS[part], config, self.data)
        return self.log[1]


def main() -> None:
    """Run what is missing, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where finished folds are kept")
    parser.add_argument(
        "--parts",
        nargs="*",
        choices=PARTS,
        default=list(PARTS),
        help="whose tables are made",
    )
    tests = sorted({test for part in PARTS.values() for test in part.tests})
    parser.add_argument("--tests", nargs="*", choices=tests, default=tests)
    rows = [*ROWS, *(row for of_cue in TRIED.values() for row in of_cue if row not in ROWS)]
    cues = sorted({name for row in rows for name in (row.name, row.cue)})
    columns = sorted({name for row in rows for of_test in row.columns.values() for name in of_test})
    parser.add_argument("--cues", nargs="*", choices=cues, default=cues, metavar="CUE")
    parser.add_argument("--classifiers", nargs="*", choices=columns, default=columns)
    parser.add_argument("--page", type=Path, default=PAGE)
    given = parser.parse_args()
    if "PLACECUE_DATA" not in os.environ:
        raise SystemExit("PLACECUE_DATA is not set: it names the folder of recorded data")
    bench = Bench(Results(given.folder), Path(os.environ["PLACECUE_DATA"]))
    for row in rows:
        if row.part in given.parts and {row.name, row.cue} & set(given.cues):
            bench.run(row, given.tests, given.classifiers)
    write(given.page, bench.results, given.parts)


if __name__ == "__main__":
    main()
