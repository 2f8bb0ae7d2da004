"""A task: train the single-cue models of one cue on a part, and let them score others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.cue import Cue
from placecue.cue_model import CueModel
from placecue.errors import PlacecueError
from placecue.evaluation.protocol.bench import Bench
from placecue.evaluation.protocol.choosing import chosen
from placecue.evaluation.protocol.methods import SingleCue
from placecue.evaluation.protocol.pairs import Part
from placecue.evaluation.protocol.scores_store import Said, ScoresStore
from placecue.grams import Grams, keeping
from placecue.learning.costs import measured
from placecue.learning.samples import Samples
from placecue.scores import Scores
from placecue.storage.grams import StoredGrams

#: Stands for the training samples, scored out of fold.
HELD_OUT = "held out"


@dataclass(frozen=True)
class SingleCueTask:
    """Models of one cue, trained on the same samples.

    Parameters
    ----------
    bench : Bench
    world : str
    train : tuple of Part
    chosen_on : Part or None
        What parameters are chosen on; None: by folds of the training samples.
    tests : tuple of Part
        What the models score.
    models : tuple of SingleCue
        All of one cue.
    digests : mapping of (str, str) to str
        Of what each model says of each test, and of :data:`HELD_OUT` samples, by names; what is
        there already is not computed again.
    wants_costs : bool
        Whether an integrator wants to know what a sample takes.
    """

    bench: Bench
    world: str
    train: tuple[Part, ...]
    chosen_on: Part | None
    tests: tuple[Part, ...]
    models: tuple[SingleCue, ...]
    digests: Mapping[tuple[str, str], str]
    wants_costs: bool = False

    def __str__(self) -> str:
        where = f"{self.world}: " if self.world else ""
        return f"{where}{', '.join(m.name for m in self.models)} on {_names(self.train)}"


@dataclass
class _Trained:
    model: CueModel
    spec: SingleCue
    scale: float
    settings: dict[str, Any]
    seconds: float


def train_and_score(task: SingleCueTask) -> dict[tuple[str, str], str]:
    """Train the models of a task and keep what they say.

    Returns
    -------
    dict of (str, str) to str
        Why a model has nothing to say of a test, by names; empty where all went well.
    """
    return _Run(task).run()


class _Run:
    def __init__(self, task: SingleCueTask) -> None:
        self.task = task
        self.registry = current_plugins().registry
        self.store = ScoresStore(task.bench.folder, self.registry)
        self.wrong: dict[tuple[str, str], str] = {}
        self.name = str(task.models[0].cue["plugin"])

    def run(self) -> dict[tuple[str, str], str]:
        with keeping(StoredGrams(self.task.bench.cache)):
            trained = [each for spec in self._lacking() if (each := self._trained(spec))]
            if trained:
                self._held_out(trained)
            for test in self.task.tests:
                self._score(trained, test)
        return self.wrong

    def _lacking(self) -> Iterator[SingleCue]:
        """Yield the models of which anything is not there yet."""
        for spec in self.task.models:
            needed = [d for (name, _), d in self.task.digests.items() if name == spec.name]
            if any(digest not in self.store for digest in needed):
                yield spec

    def _cue(self) -> Cue:
        cue: Cue = build(self.task.models[0].cue, "cue", self.registry)
        return cue

    def _samples(self, parts: Sequence[Part], cue: Cue) -> Samples:
        return self.task.bench.samples(self.task.world, parts, self.name, cue)

    def _trained(self, spec: SingleCue) -> _Trained | None:
        try:
            return self._train(spec)
        except PlacecueError as error:
            for test in [*map(str, self.task.tests), HELD_OUT]:
                self.wrong[spec.name, test] = f"{spec.name} on {_names(self.task.train)}: {error}"
            return None

    def _train(self, spec: SingleCue) -> _Trained:
        began, cue = perf_counter(), self._cue()
        samples = self._samples(self.task.train, cue)
        training = samples.training_set(self.name, cue)
        classifier = build(spec.classifier, "classifier", self.registry, spec.name)
        model = CueModel(cue, classifier)
        if self.task.chosen_on is None:
            model.fit(training)
            settings = dict(getattr(model.classifier, "chosen_", {}))
            scale = _rms(model.scores(training.features))
        else:
            others = self._samples([self.task.chosen_on], cue)
            found = others.features(self.name, cue)
            labels = others.labels[found.rows]
            model, settings = chosen(model, training, found.features, labels)
            scale = _rms(model.scores(found.features))
        model.trained_on = samples.which()
        return _Trained(model, spec, scale, settings, perf_counter() - began)

    def _held_out(self, trained: Sequence[_Trained]) -> None:
        """Keep what copies of each model say of training samples that they have not seen."""
        for each in trained:
            digest = self.task.digests.get((each.spec.name, HELD_OUT))
            if digest is None or digest in self.store:
                continue
            samples, cue = self._samples(self.task.train, each.model.cue), each.model.cue
            try:
                rows = samples.trained_on(self.name, cue)
                training = samples.training_set(self.name, cue)
                scores = each.model.held_out(training, samples.folds, name=each.spec.name)
            except PlacecueError as error:
                self.wrong[each.spec.name, HELD_OUT] = f"{each.spec.name}: {error}"
                continue
            self._keep(digest, each, samples, scores.spread(rows, len(samples)), 0.0)

    def _score(self, trained: Sequence[_Trained], test: Part) -> None:
        for each in trained:
            key = each.spec.name, str(test)
            digest = self.task.digests.get(key)
            if digest is None or digest in self.store:
                continue
            began = perf_counter()
            try:
                samples = self._samples([test], each.model.cue)
                scores = self._said(each.model, samples)
            except PlacecueError as error:
                self.wrong[key] = f"{each.spec.name} on {test}: {error}"
                continue
            self._keep(digest, each, samples, scores, perf_counter() - began)

    def _said(self, model: CueModel, samples: Samples) -> Scores:
        found = samples.features(self.name, model.cue)
        if found.features is None:
            nothing = np.empty((0, len(model.layout.columns)))
            return Scores(nothing, model.layout).spread(found.rows, len(samples))
        scored = model.tried(found.features, skip=self.task.bench.skip)
        return scored.spread(found.rows, len(samples))

    def _keep(
        self, digest: str, each: _Trained, samples: Samples, scores: Scores, seconds: float
    ) -> None:
        self.store.save(
            digest,
            Said(
                scores,
                samples.labels,
                samples.stamps,
                samples.positions,
                samples.groups,
                each.scale,
                self._cost(each.model),
                {"training": each.seconds, "testing": seconds},
                each.settings,
            ),
        )

    def _cost(self, model: CueModel) -> float:
        """Return what a sample takes, ms, measured once a cue and process."""
        if not self.task.wants_costs:
            return float("nan")
        if not hasattr(self, "_measured"):
            samples = self._samples(self.task.train, model.cue)
            with keeping(Grams()):  # as when a robot asks about one image
                self._measured = measured({self.name: model}, samples.reread())[self.name]
        return self._measured


def _rms(scores: Scores) -> float:
    values = scores.values[scores.available()]
    return float(np.sqrt(np.mean(values**2))) if values.size else 1.0


def _names(parts: Sequence[Part]) -> str:
    return " + ".join(map(str, parts))
