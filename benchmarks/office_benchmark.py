"""Experiments 1 to 4 of the paper on the simulated benchmark: every cue, and both by SVM-DAS.

python benchmarks/office_benchmark.py out --worlds 0 1 2 3 4 --methods laser adaboost crfh
python benchmarks/office_benchmark.py out --report

Results are kept in the folder ``out`` as they come, one JSON line a pair of sequences; what is
there is not computed again. Cues and classifiers are those of the shipped options. Each model is
trained on one sequence. Its C and gamma are those of the option's search that do best on the
sequence of the next illumination and the other run close in time, which no experiment tests it on;
AdaBoost has nothing to choose. SVM-DAS is fitted on the outputs that the models of one sequence
give in all experiments, and used with the models of the other run close in time.
"""

from __future__ import annotations

import argparse
import json
import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import joblib
import numpy as np
from cues_and_classifiers import components, config_of
from numpy.typing import NDArray
from sklearn.metrics import balanced_accuracy_score, recall_score

from placecue.classifier import Classifier
from placecue.cue import Cue
from placecue.evidence import StoredEvidence
from placecue.grams import KeptGrams, keeping
from placecue.learning.collecting import collect
from placecue.learning.samples import Samples
from placecue.scores import Scores
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from placecue_office.simulator import Office

LIGHTS = ("cloudy", "night", "sunny")
PARTNER = {1: 2, 2: 1, 3: 4, 4: 3}  # close in time
LATER = {1: 3, 2: 4, 3: 1, 4: 2}  # half a year apart
#: What the paper says, %: Experiment 1, then what light and time cost from there.
PAPER = {
    "crfh": ("95.1", "79.8", "85 to 88", ""),
    "laser": ("92.5", "90.6 to 91.9", "84.6 to 88.8", ""),
    "adaboost": ("86.4", "", "", ""),
    "svm_das": ("", "", "", ""),
}


class Sequence(NamedTuple):
    """One of the twelve."""

    light: str
    run: int

    @property
    def name(self) -> str:
        return f"{self.light}{self.run}"

    def other_lights(self) -> list[str]:
        """Return the other illuminations, the next one first."""
        at = LIGHTS.index(self.light)
        return [*LIGHTS[at + 1 :], *LIGHTS[:at]]

    def tests(self) -> list[tuple[int, Sequence]]:
        """Return the experiments and the sequences that a model of this one is tested on."""
        partner, later = PARTNER[self.run], LATER[self.run]
        others = self.other_lights()
        return [
            (1, Sequence(self.light, partner)),
            *((2, Sequence(light, self.run)) for light in others),
            (3, Sequence(self.light, later)),
            *((4, Sequence(light, later)) for light in others),
        ]

    def chosen_on(self) -> Sequence:
        """Return the sequence that C and gamma are chosen on; no experiment tests on it."""
        return Sequence(self.other_lights()[0], PARTNER[self.run])


#: Ordered pairs of sequences in the four experiments.
PAIRS = 72
SEQUENCES = [Sequence(light, run) for light in LIGHTS for run in PARTNER]


class Method(NamedTuple):
    """A shipped option of a cue and its classifier, as after ``placecue train``.

    Parameters
    ----------
    cue : str
        The cue's option.
    overrides : tuple of str
        What else is set.
    every : int
        Takes every so-many-th observation.
    """

    cue: str
    overrides: tuple[str, ...] = ()
    every: int = 1

    def built(self) -> tuple[Cue, Classifier]:
        """Build cue and classifier."""
        return components(config_of([f"cue=[{self.cue}]", "integrator=none", *self.overrides]))


METHODS = {
    "laser": Method("laser"),
    "adaboost": Method("laser", ("classifier@cues.laser.classifier=adaboost",)),
    "crfh": Method("crfh", every=3),
}
#: What SVM-DAS joins.
JOINED = ["laser", "crfh"]


#: Tried for SVM-DAS by cross-validation on what it is fitted on.
DAS_GRID = {"C": [1.0, 10.0, 100.0], "gamma": [0.03, 0.3]}


class Bench:
    """One world of the benchmark.

    Parameters
    ----------
    folder : Path
        Where results are kept.
    seed : int
        The world.
    settings : dict
        Parameters of the source beside seed, illumination and run.
    every : int or None
        Takes every so-many-th observation; None leaves it to the method.
    """

    def __init__(
        self, folder: Path, seed: int, settings: dict[str, object], every: int | None = None
    ) -> None:
        self.folder = folder
        self.seed = seed
        self.settings = settings
        self.every = every
        folder.mkdir(parents=True, exist_ok=True)

    def samples(self, name: str, sequence: Sequence, every: int) -> Samples:
        """Return the features of one sequence by a method's cue, extracted once."""
        cue = METHODS[name].cue
        path = self.folder / "features" / f"{cue}{every}_{self.seed}_{sequence.name}.joblib"
        if not path.exists():
            path.parent.mkdir(exist_ok=True)
            office = Office(
                seed=self.seed,
                illumination=sequence.light,
                run=sequence.run,
                **self.settings,  # type: ignore[arg-type]
            )
            taken = (each for number, each in enumerate(office) if number % every == 0)
            made = collect(taken, {cue: METHODS[name].built()[0]})
            joblib.dump(replace(made, observations=()), path)
        return joblib.load(path)  # type: ignore[no-any-return]

    def run(self, name: str) -> None:
        """Train and test one method on all pairs that are not there yet."""
        done = {(row["train"], row["test"]) for row in self.rows() if row["method"] == name}
        for sequence in SEQUENCES:
            if all((sequence.name, test.name) in done for _, test in sequence.tests()):
                continue
            classifier, chosen = self.trained(name, sequence)
            for experiment, test in sequence.tests():
                samples = self.samples(name, test, self.stride(name))
                scores = classifier.scores(self.features(name, samples))
                path = self.folder / "scores" / f"{name}_{self.seed}_{sequence.name}_{test.name}"
                path.parent.mkdir(exist_ok=True)
                joblib.dump((scores, samples.stamps), path)
                self.keep(name, experiment, sequence, test, scores.decide().labels, samples, chosen)

    def stride(self, name: str) -> int:
        """Return which part of the observations a method takes."""
        return self.every or METHODS[name].every

    @staticmethod
    def features(name: str, samples: Samples) -> Any:
        """Return the features of a method's cue."""
        return samples.extracted[METHODS[name].cue].features[0]

    def trained(self, name: str, sequence: Sequence) -> tuple[Classifier, dict[str, float]]:
        """Return the classifier of a sequence, C and gamma chosen on another one, and these."""
        cue, classifier = METHODS[name].built()
        ours = self.samples(name, sequence, self.stride(name)).training_set(METHODS[name].cue, cue)
        if not isinstance(classifier, SVM) or not classifier.search:
            classifier.train(ours)
            return classifier, {}
        theirs = self.samples(name, sequence.chosen_on(), self.stride(name))
        best, kept, chosen = -1.0, classifier, {}
        with keeping(KeptGrams()):
            for values in product(*classifier.search.values()):
                setting = dict(zip(classifier.search, values, strict=True))
                svm = classifier.with_setting(setting).set_params(search=None)
                decided = svm.train(ours).scores(self.features(name, theirs)).decide().labels
                score = balanced_accuracy_score(theirs.labels, decided)
                if score > best:
                    best, kept, chosen = score, svm, setting
        return kept, chosen

    def integrate(self, cues: list[str]) -> None:
        """Fit SVM-DAS for each sequence and use it with the models of the other run."""
        done = {(row["train"], row["test"]) for row in self.rows() if row["method"] == "svm_das"}
        for sequence in SEQUENCES:
            fitted_on = Sequence(sequence.light, PARTNER[sequence.run])
            if all((sequence.name, test.name) in done for _, test in sequence.tests()):
                continue
            known = [self.joined(cues, fitted_on, test) for _, test in fitted_on.tests()]
            evidence = StoredEvidence(
                {cue: _chained([of_cue[cue] for of_cue, _ in known]) for cue in cues}
            )
            svm = SVM(kernel=RBF(), multiclass="oao", search=DAS_GRID)
            labels, stamps = (
                np.concatenate([getattr(samples, part) for _, samples in known])
                for part in ("labels", "stamps")
            )
            das = SVMDAS(svm).fit(evidence, labels, stamps)
            for experiment, test in sequence.tests():
                of_cue, samples = self.joined(cues, sequence, test)
                decided = das.integrate(StoredEvidence(of_cue)).decide()
                self.keep("svm_das", experiment, sequence, test, decided.labels, samples, {})

    def joined(
        self, cues: list[str], train: Sequence, test: Sequence
    ) -> tuple[dict[str, Scores], Samples]:
        """Return the scores of all cues where all have one, and the samples."""
        loaded = {
            cue: joblib.load(self.folder / "scores" / f"{cue}_{self.seed}_{train.name}_{test.name}")
            for cue in cues
        }
        stamps = loaded[cues[0]][1]
        for _, other in loaded.values():
            stamps = np.intersect1d(stamps, other)
        slowest = max(cues, key=self.stride)
        samples = self.samples(slowest, test, self.stride(slowest))
        return {
            cue: scores[np.isin(when, stamps)] for cue, (scores, when) in loaded.items()
        }, samples

    def keep(
        self,
        method: str,
        experiment: int,
        train: Sequence,
        test: Sequence,
        decided: NDArray[np.str_],
        samples: Samples,
        chosen: dict[str, float],
    ) -> None:
        """Append the result of one pair."""
        classes = np.unique(samples.labels)
        recalls = recall_score(samples.labels, decided, labels=classes, average=None)
        row = {
            **{"world": self.seed, "method": method, "experiment": experiment},
            **{"train": train.name, "test": test.name, "score": float(np.mean(recalls))},
            **{"recalls": dict(zip(classes.tolist(), recalls.tolist(), strict=True)), **chosen},
        }
        with (self.folder / f"world{self.seed}.jsonl").open("a") as file:
            file.write(json.dumps(row) + "\n")

    def rows(self) -> Iterator[dict[str, object]]:
        """Yield the results of this world so far."""
        path = self.folder / f"world{self.seed}.jsonl"
        if path.exists():
            yield from map(json.loads, path.read_text().splitlines())


def _chained(scores: list[Scores]) -> Scores:
    return Scores(np.vstack([each.values for each in scores]), scores[0].layout)


def report(folder: Path) -> str:
    """Return a Markdown table of the worlds that are done: mean, and spread over worlds."""
    rows = [
        json.loads(line)
        for path in sorted(folder.glob("world*.jsonl"))
        for line in path.read_text().splitlines()
    ]
    lines = ["| method | worlds | Exp 1 | Exp 2 | Exp 3 | Exp 4 |", "|---|---|---|---|---|---|"]
    for method in PAPER:
        of_method = [row for row in rows if row["method"] == method]
        pairs = Counter(row["world"] for row in of_method)
        worlds = sorted(world for world, count in pairs.items() if count == PAIRS)
        if not worlds:
            continue
        cells = []
        for experiment in (1, 2, 3, 4):
            means = [
                100 * np.mean(scores)
                for world in worlds
                if (
                    scores := [
                        row["score"]
                        for row in of_method
                        if row["world"] == world and row["experiment"] == experiment
                    ]
                )
            ]
            spread = f" ± {np.std(means, ddof=1):.1f}" if len(means) > 1 else ""
            cells.append(f"{np.mean(means):.1f}{spread}" if means else "")
        lines.append(f"| {method} | {len(worlds)} | " + " | ".join(cells) + " |")
        if any(PAPER[method]):
            lines.append(f"| {method}, the paper | | " + " | ".join(PAPER[method]) + " |")
    return "\n".join(lines)


def measure(folder: Path, world: int, methods: list[str], settings: dict[str, object]) -> None:
    """Run every method on one world, then both cues."""
    bench = Bench(folder, world, settings)
    for name in methods:
        bench.run(name)
    if set(JOINED) <= set(methods):
        bench.integrate(JOINED)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--worlds", type=int, nargs="*", default=[0, 1, 2, 3, 4])
    parser.add_argument("--methods", nargs="*", default=list(METHODS), choices=METHODS)
    parser.add_argument("--set", nargs="*", default=[], help="other parameters: route=idol2 ...")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--report", action="store_true", help="only print the table")
    given = parser.parse_args()
    words = (word.partition("=") for word in given.set)
    changed = {
        name: json.loads(value) if value[:1].isdigit() else value for name, _, value in words
    }
    if not given.report:
        joblib.Parallel(given.jobs)(
            joblib.delayed(measure)(
                given.out, world, given.methods, {"speed": 0.4, "turn_rate": 0.7, **changed}
            )
            for world in given.worlds
        )
    print(report(given.out))
