"""The integrators that are compared, and what they decide, kept in a folder.

The rules over probabilities are given calibrated cues: the scores of each are mapped to
probabilities by what was learned (logistic regression) on the samples that integrators are fitted
on. All others have the scores as they are.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from cues_and_classifiers import REGISTRY
from hydra import compose, initialize_config_module
from integration_tests import TESTS, Said, evidence
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression

from placecue import HeldOut, Integrator, Probabilities, Schemes, Scores, StoredEvidence
from placecue.components.build import build, plain
from placecue.components.options import register_with_hydra

SETS: tuple[tuple[str, ...], ...] = (
    ("crfh", "sift"),
    ("crfh", "laser"),
    ("sift", "laser"),
    ("crfh", "sift", "laser"),
    ("fisher", "colour", "laser"),
)
#: Words that choose each integrator, as after ``placecue train``; none of what is no integrator.
METHODS: dict[str, list[str] | None] = {
    "best cue": None,
    "gdas": ["integrator=gdas"],
    "svm_das": ["integrator=svm_das"],
    "svm_das_linear": ["integrator=svm_das_linear"],
    "svm_das_hi": ["integrator=svm_das_hi"],
    "confidence": ["integrator=confidence"],
    "vote": ["integrator=vote"],
    "mean_probability": ["integrator=mean_probability"],
    "product_probability": ["integrator=product_probability"],
    "max_probability": ["integrator=max_probability"],
    "stacking": ["integrator=stacking"],
    "dynamic": ["integrator=dynamic"],
    "joint": None,
}
ON_PROBABILITIES = {"mean_probability", "product_probability", "max_probability"}
#: The set that low-level integration is compared on, as in the paper.
JOINT = ("crfh", "laser")


def decide(folder: Path, test: str, cues: Sequence[str], method: str) -> list[dict[str, Any]]:
    """Return what a method decides in every part of a test, computed once.

    Returns
    -------
    list of dict
        One a part: truth, scene and decision of each sample that any cue has, share of the samples
        each cue was used for, and seconds of fitting.
    """
    path = folder / "decisions" / test / f"{'+'.join(cues)}_{method.replace(' ', '_')}.json"
    if path.exists():
        known: list[dict[str, Any]] = json.loads(path.read_text())
        return known
    if method == "joint" and tuple(cues) != JOINT:
        return []
    print(f"{test}: {method} of {'+'.join(cues)}", flush=True)
    made = [_part(folder, test, part, tuple(cues), method) for part in TESTS[test].parts()]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(made))
    return made


def _part(folder: Path, test: str, part: str, cues: tuple[str, ...], method: str) -> dict[str, Any]:
    names = ("joint_rbf",) if method == "joint" else cues
    of_part = {cue: evidence(folder, test, part, cue) for cue in names}
    other, testing = TESTS[test].fitted_on(part)
    of_other = {cue: evidence(folder, test, other, cue) for cue in names}
    fitted = {cue: each.testing if testing else each.fitting for cue, each in of_other.items()}
    tested = {cue: each.testing for cue, each in of_part.items()}
    if method in ON_PROBABILITIES:
        maps = {cue: _calibrated(said) for cue, said in fitted.items()}
        fitted = {cue: maps[cue](said) for cue, said in fitted.items()}
        tested = {cue: maps[cue](said) for cue, said in tested.items()}
    fitting, _ = _joined(fitted)
    fitting = HeldOut(
        fitting.evidence,
        fitting.labels,
        fitting.stamps,
        fitting.groups,
        TESTS[test].folds,
        part=True,
        costs={cue: each.cost for cue, each in of_part.items()},
    )
    unseen, scenes = _joined(tested)
    began = perf_counter()
    if METHODS[method] is None:
        cue = _best(fitting)
        decided, used = _decided(unseen.evidence.scores(cue)), {cue: 1.0}
    else:
        schemes = Schemes.fit(_integrator(method), fitting)
        evidence_ = Counting(unseen.evidence)
        decided = _decided(schemes.integrate(evidence_)[0])
        used = evidence_.shares()
    return {
        "part": part,
        "truth": unseen.labels.tolist(),
        "scenes": scenes.tolist(),
        "decided": decided.tolist(),
        "used": used,
        "costs": fitting.costs,
        "seconds": perf_counter() - began,
    }


def _integrator(method: str) -> Integrator:
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = plain(compose("train", [*(METHODS[method] or []), "log=here"]))
    made: Integrator = build(config["integrator"], "integrator", REGISTRY)
    return made


def _joined(said: dict[str, Said]) -> tuple[HeldOut, NDArray[Any]]:
    """Return the evidence of all cues, with gaps, and the scene of each sample."""
    keys = {cue: list(zip(s.scenes.tolist(), s.stamps.tolist(), strict=True))
            for cue, s in said.items()}  # fmt: skip
    every = sorted(set().union(*keys.values()))
    at = {key: row for row, key in enumerate(every)}
    n = len(every)
    labels, stamps, scenes = np.empty(n, "U40"), np.empty(n, np.int64), np.empty(n, "U80")
    first = next(iter(said.values())).groups
    groups = None if first is None else np.zeros((n, *first.shape[1:]), np.int64)
    scores = {}
    for cue, each in said.items():
        rows = np.array([at[key] for key in keys[cue]])
        scores[cue] = each.scores.spread(rows, n)
        labels[rows], stamps[rows], scenes[rows] = each.labels, each.stamps, each.scenes
        if groups is not None:
            groups[rows] = each.groups
    return HeldOut(StoredEvidence(scores), labels, stamps, groups), scenes


def _decided(scores: Scores) -> NDArray[Any]:
    """Return what is decided, empty where nothing is."""
    there = scores.available()
    decided = np.full(len(scores), "", dtype="U40")
    decided[there] = scores[there].decide().labels
    return decided


def _best(fitting: HeldOut) -> str:
    """Return the cue that is best on the samples that integrators are fitted on."""

    def rate(cue: str) -> float:
        right = _decided(fitting.evidence.scores(cue)) == fitting.labels
        return float(np.mean([right[fitting.labels == c].mean() for c in set(fitting.labels)]))

    return max(fitting.evidence.cues, key=rate)


def _calibrated(said: Said) -> Any:
    """Return what maps the scores of a cue to probabilities, learned on what it says."""
    there = said.scores.available()
    values = said.scores.values[there]
    centre, scale = values.mean(axis=0), values.std(axis=0)
    model = LogisticRegression(C=1.0, class_weight="balanced", max_iter=2000)
    model.fit((values - centre) / scale, said.labels[there])

    def apply(other: Said) -> Said:
        rows = np.flatnonzero(other.scores.available())
        given = model.predict_proba((other.scores.values[rows] - centre) / scale)
        scores = Scores(given, Probabilities(said.scores.layout.classes))
        return Said(
            scores.spread(rows, len(other.labels)),
            other.labels,
            other.stamps,
            other.groups,
            other.scenes,
        )

    return apply


class Counting(StoredEvidence):
    """Counts for how many of the samples each cue is asked."""

    def __init__(self, stored: StoredEvidence | Any) -> None:
        super().__init__({cue: stored.scores(cue) for cue in stored.cues})
        self.asked = {cue: np.zeros(len(self), dtype=bool) for cue in self.cues}
        self.rows = np.arange(len(self))

    def scores(self, cue: str) -> Scores:
        """Return the scores of a cue, and note that it was asked."""
        if hasattr(self, "asked"):
            self.asked[cue][self.rows] = True
        return super().scores(cue)

    def layout(self, cue: str) -> Any:
        """Return the layout of a cue; that is not asking it."""
        return self._scores[cue].layout

    def available(self, cue: str) -> NDArray[np.bool_]:
        """Return where a cue is there; that is not asking it."""
        return self._scores[cue].available()

    def take(self, rows: Any) -> Counting:
        """Return some of the samples; what is asked of them is noted here."""
        some = np.arange(len(self))[np.asarray(rows)]
        return self._like({cue: self._scores[cue][some] for cue in self.cues}, some)

    def only(self, cues: Sequence[str]) -> Counting:
        """Return some of the cues; what is asked of them is noted here."""
        return self._like({cue: self._scores[cue] for cue in cues}, np.arange(len(self)))

    def _like(self, scores: dict[str, Scores], some: NDArray[np.int64]) -> Counting:
        made = Counting.__new__(Counting)
        StoredEvidence.__init__(made, scores)
        made.asked, made.rows = self.asked, self.rows[some]
        return made

    def shares(self) -> dict[str, float]:
        """Return for which share of the samples each cue was asked."""
        return {cue: float(asked.mean()) for cue, asked in self.asked.items()}
