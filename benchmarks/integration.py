"""Fitting integrators, and integrating one sample: ``python benchmarks/integration.py``.

Scores of 950 samples of 5 classes by 4 cues, one-against-one, drawn at random: margins of 1 or so
with as much noise. On one thread. Each aim is a ratio to a peer that does the same in the same
run, or milliseconds. Integrators come by the names of their options, those of plugins too.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
from hydra import compose, initialize_config_module
from sklearn.metrics import balanced_accuracy_score
from sklearn.model_selection import GridSearchCV
from sklearn.preprocessing import MinMaxScaler
from sklearn.svm import SVC

from placecue import (
    HeldOut,
    Integrator,
    Layout,
    OneAgainstAll,
    OneAgainstOne,
    PlacecueError,
    Probabilities,
    Schemes,
    Scores,
    StoredEvidence,
)
from placecue.components.build import build, plain
from placecue.components.manager import load_plugins
from placecue.components.options import option_files, register_with_hydra
from placecue_integrators.simplex import simplex

SAMPLES, CUES, PLACES = 950, 4, ("corridor", "kitchen", "lab", "office", "printer")
STAMPS = np.arange(SAMPLES) * 200_000_000
#: Samples asked for one at a time.
ASKED = 300
REGISTRY = load_plugins().registry


def held_out(layout: Layout) -> HeldOut:
    """Scores of samples in stretches of one place each, as of a drive."""
    generator = np.random.default_rng(0)
    codes = np.arange(SAMPLES) // 38 % len(PLACES)
    scores = {}
    for cue in range(CUES):
        own = np.eye(len(PLACES))[codes] * (2 - 0.3 * cue)
        own += generator.normal(size=own.shape)
        if isinstance(layout, OneAgainstOne):
            own = np.stack([own[:, i] - own[:, j] for i, j in layout.pairs], axis=1)
        elif isinstance(layout, Probabilities):
            own = np.exp(own) / np.exp(own).sum(axis=1, keepdims=True)
        scores[f"cue {cue}"] = Scores(own, layout)
    costs = {cue: 10.0**number for number, cue in enumerate(scores)}
    labels = np.array(PLACES)[codes]
    return HeldOut(StoredEvidence(scores), labels, STAMPS, costs=costs)


def options() -> list[str]:
    """The names of all integrators: option files, and components that have none."""
    files = [name for name in option_files("pkg://placecue_conf") if name.startswith("integrator/")]
    named = {name.removeprefix("integrator/").removesuffix(".yaml") for name in files}
    return sorted((named | set(REGISTRY.names("integrator"))) - {"none"})


def integrator(option: str) -> Integrator:
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = compose("train", ["log=x", f"integrator={option}"])
    made: Integrator = build(plain(config)["integrator"], "integrator", REGISTRY)
    return made


def seconds(call: Callable[[], Any], repeats: int = 1) -> float:
    """The fastest of some calls: others may be at work on the machine."""
    taken = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        taken.append(perf_counter() - start)
    return min(taken)


def weights_by_scikit_learn(samples: HeldOut, steps: int) -> None:
    """The same grid by the layout's rule and scikit-learn's score."""
    evidence = samples.evidence
    outputs = [evidence.scores(cue).values for cue in evidence.cues]
    layout = evidence.layout(evidence.cues[0])
    for weights in simplex(CUES, steps) / steps:
        total = sum(weight * output for weight, output in zip(weights, outputs, strict=True))
        balanced_accuracy_score(samples.labels, layout.decide(total).labels)


def fit_gdas(samples: HeldOut) -> None:
    gdas: Any = integrator("gdas")
    gdas.train(samples)  # compiles
    ours = seconds(lambda: gdas.train(samples), 3)
    peer = seconds(lambda: weights_by_scikit_learn(samples, round(1 / gdas.step)))
    print(f"fit gdas: {ours:.3f} s (aim: under 2 s), peer {peer:.1f} s, {peer / ours:.0f}x (50x)")


def fit_svm_das(samples: HeldOut, option: str) -> None:
    """The peer has the same grid, folds and scaled scores, and trains on all samples at the end."""
    das: Any = integrator(option)
    ours = seconds(lambda: das.train(samples), 2)
    evidence = samples.evidence
    joined = np.hstack([evidence.scores(cue).values for cue in evidence.cues])
    scaled = MinMaxScaler((-1, 1)).fit_transform(joined)
    kernel = {"svm_das": "rbf", "svm_das_linear": "linear"}.get(option, _smaller_sums)
    search = GridSearchCV(
        SVC(kernel=kernel, class_weight="balanced"),
        das.classifier.search,
        cv=samples.split(),
        scoring="balanced_accuracy",
    )
    peer = seconds(lambda: search.fit(scaled, samples.labels), 1)
    best = max(das.classifier_.search_["balanced_accuracy"]), search.best_score_
    print(
        f"fit {option}: {ours:.2f} s, peer {peer:.2f} s, {peer / ours:.1f}x (aim: 5x); "
        f"best {100 * best[0]:.1f} and {100 * best[1]:.1f} %"
    )


def _smaller_sums(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Histogram intersection of scores in [-1, 1], as numpy would have it."""
    return np.minimum(a[:, None] + 1, b[None] + 1).sum(axis=2)


def one_at_a_time(option: str, every: list[HeldOut]) -> None:
    """Integrate and decide, from scores that are there, as a pipeline does for each observation."""
    reason = ""
    for samples in every:
        fitted = integrator(option)
        try:
            fitted.train(samples)
            break
        except PlacecueError as error:
            reason = str(error)
    else:
        print(f"integrating one sample by {option}: not measured: {reason}")
        return
    schemes = Schemes({samples.evidence.cues: fitted})
    asked = [samples.evidence.take([row]) for row in range(ASKED)]
    times = [1e3 * seconds(lambda e=each: schemes.integrate(e)[0].decide(), 2) for each in asked]
    print(
        f"integrating one sample by {option} ({samples.evidence.layout('cue 0').name}): "
        f"median {np.median(times):.3f} ms, 95 % {np.quantile(times, 0.95):.3f} ms "
        "(aim: under 0.3 ms)"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="leave out fitting svm_das")
    quick = parser.parse_args().quick
    every = [held_out(kind(PLACES)) for kind in (OneAgainstOne, OneAgainstAll, Probabilities)]
    fit_gdas(every[0])
    for option in () if quick else ("svm_das", "svm_das_linear", "svm_das_hi"):
        fit_svm_das(every[0], option)
    for option in options():
        one_at_a_time(option, every)


if __name__ == "__main__":
    main()
