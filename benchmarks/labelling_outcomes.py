"""Labels logs by accumulators, and keeps what came of each as it comes."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from hydra import compose, initialize_config_module
from labelling_data import REGISTRY, Data, Moments
from labelling_plan import Test

from placecue import Accumulator, SemanticMap
from placecue.components.build import build, plain
from placecue.components.options import register_with_hydra
from placecue.evaluation.area_scores import AreaTally, Distribution, TruthAt
from placecue.free_space import FreeSpace, Grid
from placecue.semantic_map import UNKNOWN

Outcome = dict[str, Any]


def accumulator(words: Sequence[str]) -> Accumulator:
    """Return the accumulator that ``placecue label`` with some words would take, as new."""
    made = _accumulator(tuple(words))
    made.reset()
    return made


@cache
def _accumulator(words: tuple[str, ...]) -> Accumulator:
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = plain(compose("label", [*words, "log=here"]))
    made: Accumulator = build(config["accumulator"], "accumulator", REGISTRY)
    return made


def labelled(
    by: Accumulator,
    moments: Moments,
    free: Grid | None = None,
    truth_at: TruthAt | None = None,
) -> tuple[SemanticMap, Outcome]:
    """Label a log; return the map and what it is worth, doorways left out.

    ``live`` is the share of moments at which the label that was said then was right.
    """
    tally, now = AreaTally(["doorway"]), UNKNOWN
    said: list[bool] = []
    for seen, belief in moments:
        update = by.update(seen, belief)
        tally.observe(seen, belief, update)
        now = now if update is None or update.finished else update.label
        if seen.pose is not None and seen.label not in (None, "doorway"):
            said.append(now == seen.label)
    made = by.semantic_map()
    scores = asdict(tally.scores(made, free, truth_at))
    areas, nodes = tally.distributions(made)
    live = sum(said) / len(said) if said else None
    return made, {
        **scores,
        "live": live,
        "areas_said": _said(areas),
        "nodes_said": _said(nodes),
    }


def singles(moments: Moments) -> dict[str, int]:
    """Return how often single beliefs say each class."""
    return dict(Counter(belief.label for _, belief in moments if belief is not None))


def free_space(moments: Moments) -> Grid | None:
    """Return the free space of a log."""
    space = FreeSpace()
    for seen, _ in moments:
        space.observe(seen)
    return space.grid()


def _said(found: Sequence[Distribution]) -> list[list[float]]:
    """Return the largest probability, whether it is of the true class, and that of the latter."""
    rows = []
    for each in found:
        best = max(each.probabilities, key=lambda name: each.probabilities[name])
        true = each.probabilities.get(each.truth, 0.0)
        rows.append([each.probabilities[best], float(best == each.truth), true])
    return rows


def log_loss(said: Sequence[Sequence[float]]) -> float:
    """Return the mean negative logarithm of the probability of the true class."""
    return float(-np.log(np.maximum([row[2] for row in said], 1e-6)).mean())


def calibration_error(said: Sequence[Sequence[float]], bins: int = 10) -> float:
    """Return the expected calibration error (Guo et al., ICML 2017)."""
    given, right = np.array(said)[:, :2].T
    number = np.minimum((given * bins).astype(int), bins - 1)
    gaps = [abs(given[number == b].sum() - right[number == b].sum()) for b in range(bins)]
    return float(sum(gaps) / len(given))


class Outcomes:
    """What came of each setting on each test, a line of JSON each.

    Parameters
    ----------
    path : Path
        The file; what it holds is not computed again.
    data : Data
    whole : bool
        Whether free space is scored too, and the map is looked at.
    """

    def __init__(self, path: Path, data: Data, whole: bool = False) -> None:
        self.path = path
        self.data = data
        self.whole = whole
        self._free: dict[str, Grid | None] = {}
        self.known: dict[tuple[str, str], Outcome] = {}
        if path.exists():
            for line in path.read_text().splitlines():
                found = json.loads(line)
                self.known[found["words"], found["test"]] = found

    def of(self, words: Sequence[str], tests: Sequence[Test]) -> list[Outcome]:
        """Return what comes of some words on each test."""
        return [self._one(" ".join(words), words, test) for test in tests]

    def _one(self, key: str, words: Sequence[str], test: Test) -> Outcome:
        if (key, test.name) not in self.known:
            found = self._labelled(words, test) | {"words": key, "test": test.name}
            with self.path.open("a") as file:
                file.write(json.dumps(found) + "\n")
            self.known[key, test.name] = found
        return self.known[key, test.name]

    def _labelled(self, words: Sequence[str], test: Test) -> Outcome:
        moments = self.data.moments(test)
        if not self.whole:
            return labelled(accumulator(words), moments)[1]
        if test.name not in self._free:
            self._free[test.name] = free_space(moments)
        free, truth_at = self._free[test.name], self.data.truth_at(test, moments)
        made, found = labelled(accumulator(words), moments, free, truth_at)
        ways = sorted((len(area.trajectory), area.label) for area in made.areas)[::-1]
        rooms = self.data.rooms(test, moments, made)
        return {**found, "ways": ways, "rooms": rooms, "single_said": singles(moments)}
