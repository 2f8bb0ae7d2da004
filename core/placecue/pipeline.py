"""The path of one observation, in the paper's order: extract, score, integrate, decide, accumulate.

The paper: Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place classification,
IJRR 29(2-3), 2010, sections 3 to 5.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import islice
from typing import Self

import numpy as np

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.classifier import Classifier
from placecue.cue import Cue
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.evidence import Evidence, ObservedEvidence, OutOfFold, StoredEvidence, scored_rows
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.integrator import Integrator, OnlyCue
from placecue.observation import PARTS, Observation, Part
from placecue.progress import track
from placecue.samples import Samples, collect
from placecue.skipped import Skipped


class Pipeline:
    """Cues with their classifiers, and an integrator.

    Parameters
    ----------
    cues : mapping of str to (Cue, Classifier)
        The cues by name, in order of cost, each with its classifier.
    integrator : Integrator, optional
        Joins the cues; may be left out where there is one cue.
    folds : FoldScheme, optional
        How the training samples are cut to fit the integrator on scores that the single-cue
        models have not seen; interleaved chunks of 2 s by default.

    Examples
    --------
    >>> pipeline = Pipeline(
    ...     cues={"crfh": (CRFH(), SVM(kernel=Chi2())), "laser": (LaserGeometry(), SVM())},
    ...     integrator=SVMDAS(classifier=SVM(kernel=RBF())),
    ... ).fit(open_log("run1.mcap"))  # doctest: +SKIP
    >>> for belief in pipeline.beliefs(open_log("run2.mcap")):  # doctest: +SKIP
    ...     print(belief.stamp, belief.label, belief.confidence, belief.cues_used)
    """

    def __init__(
        self,
        cues: Mapping[str, tuple[Cue, Classifier]],
        integrator: Integrator | None = None,
        folds: FoldScheme | None = None,
    ) -> None:
        if not cues:
            raise UsageError("a pipeline needs a cue or more: for example cue=[crfh,laser]")
        if integrator is None and len(cues) > 1:
            raise UsageError(
                f"{len(cues)} cues ({', '.join(cues)}) and no integrator: choose one, such as "
                "integrator=svm_das"
            )
        self.cues = dict(cues)
        self.integrator = OnlyCue() if integrator is None else integrator
        self.folds = InterleavedChunks() if folds is None else folds

    # ------------------------------------------------------------------ one observation

    def believe(self, observations: Sequence[Observation]) -> list[Belief]:
        """Say what kind of place each observation shows.

        Parameters
        ----------
        observations : sequence of Observation
            A batch; cues are extracted only as far as the integrator asks for them.

        Returns
        -------
        list of Belief
            One an observation.

        Raises
        ------
        UnusableObservation
            If a part that a cue needs is missing or spoilt in one of them.
        """
        evidence = ObservedEvidence(observations, self.cues)  # extract and score, on demand
        scores = self.integrator.integrate(evidence)  # integrate
        decision = scores.decide()  # decide
        return [
            Belief(
                stamp=observation.stamp,
                scores=scores[row : row + 1],
                label=str(decision.labels[row]),
                confidence=float(decision.confidence[row]),
                cue_scores={cue: evidence.scores(cue, [row]) for cue in evidence.used(row)},
            )
            for row, observation in enumerate(observations)
        ]

    def label(
        self, observations: Iterable[Observation], accumulator: Accumulator, batch: int = 1
    ) -> Iterator[tuple[Observation, Belief | None, AreaUpdate | None]]:
        """Follow a log through to labelled areas, in one pass.

        Yields each observation with its belief (None where it was unusable) and what the
        accumulator made of it; ``accumulator.semantic_map()`` is the map so far.
        """
        for observation, belief in self.follow(observations, batch):
            yield observation, belief, accumulator.update(observation, belief)  # accumulate

    # ------------------------------------------------------------------ a log

    def follow(
        self, observations: Iterable[Observation], batch: int = 1
    ) -> Iterator[tuple[Observation, Belief | None]]:
        """Pair each observation with its belief, None where it was unusable.

        What was passed over is reported once, at the end.

        Parameters
        ----------
        observations : iterable of Observation
            A log; no more than ``batch`` of them are held.
        batch : int
            How many observations go through together. One keeps up with a live robot; more is
            faster over a recorded log. The beliefs are the same.

        Raises
        ------
        DataError
            If no observation was usable.
        """
        skipped, total = Skipped(), 0
        iterator = iter(observations)
        while group := list(islice(iterator, batch)):
            total += len(group)
            yield from zip(group, self._beliefs_of(group, skipped), strict=True)
        if total == 0:
            raise DataError("the log holds no observation")
        skipped.report(total)

    def beliefs(self, observations: Iterable[Observation], batch: int = 1) -> Iterator[Belief]:
        """Yield the belief of each usable observation; see :meth:`follow`."""
        return (belief for _, belief in self.follow(observations, batch) if belief is not None)

    def _beliefs_of(self, group: list[Observation], skipped: Skipped) -> list[Belief | None]:
        try:
            return list(self.believe(group))
        except UnusableObservation as error:
            if len(group) == 1:
                skipped.add(error)
                return [None]
            return [self._beliefs_of([each], skipped)[0] for each in group]

    # ------------------------------------------------------------------ training

    def fit(
        self,
        observations: Iterable[Observation],
        integration: Iterable[Observation] | None = None,
    ) -> Self:
        """Train the single-cue models, then the integrator on scores that they have not seen.

        Parameters
        ----------
        observations : iterable of Observation
            Labelled observations.
        integration : iterable of Observation, optional
            Labelled observations of another sequence to fit the integrator on. Without them it
            is fitted on out-of-fold scores of ``observations``.

        Raises
        ------
        DataError
            If there are no labels, fewer than two classes, or a class of one sample.
        """
        samples = collect(observations, {name: cue for name, (cue, _) in self.cues.items()})
        _check_classes(samples)
        for name, (cue, classifier) in track(self.cues.items(), "training", len(self.cues)):
            if cue.learns:
                cue.fit(samples.reread(), samples.labels)
            features = samples.features_of(name, cue)
            classifier.fit(features, samples.labels, samples.stamps)
        if isinstance(self.integrator, OnlyCue):
            return self
        unseen = samples
        if integration is None:
            evidence, rows = self._out_of_fold(samples)
        else:
            unseen = collect(integration, {name: cue for name, (cue, _) in self.cues.items()})
            evidence, rows = self._scored(unseen), np.arange(len(unseen))
        self.integrator.fit(evidence, unseen.labels[rows], unseen.stamps[rows])
        return self

    def _out_of_fold(self, samples: Samples) -> tuple[Evidence, Rows]:
        out_of_fold = OutOfFold(self.folds)
        scores = {
            name: out_of_fold.scores(
                classifier,
                partial(samples.features_learned_from, name, cue),
                samples.labels,
                samples.stamps,
                what=name,
            )
            for name, (cue, classifier) in self.cues.items()
        }
        rows = scored_rows(scores)
        return StoredEvidence({name: of_cue[rows] for name, of_cue in scores.items()}), rows

    def _scored(self, samples: Samples) -> Evidence:
        return StoredEvidence(
            {
                name: classifier.scores(samples.features_of(name, cue))
                for name, (cue, classifier) in self.cues.items()
            }
        )

    @property
    def requires(self) -> tuple[Part, ...]:
        """The parts of an observation that the cues need."""
        needed = {part for cue, _ in self.cues.values() for part in cue.requires}
        return tuple(part for part in PARTS if part in needed)

    @property
    def classes(self) -> tuple[str, ...]:
        """The classes that the pipeline tells apart, sorted; empty before it is fitted."""
        _, classifier = next(iter(self.cues.values()))
        layout = getattr(classifier, "layout_", None)
        return () if layout is None else layout.classes


def _check_classes(samples: Samples) -> None:
    classes, counts = np.unique(samples.labels, return_counts=True)
    if len(classes) < 2:
        raise DataError(
            f"all {len(samples)} labelled observations are '{classes[0]}': training needs two "
            "classes or more"
        )
    if counts.min() < 2:
        raise DataError(
            f"class '{classes[counts.argmin()]}' has one sample only; training needs two or more "
            "of each class: record more of it, or drop it"
        )
