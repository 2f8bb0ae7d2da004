"""The path of one observation, in the paper's order: extract, score, integrate, decide, accumulate.

The paper: Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place classification,
IJRR 29(2-3), 2010, sections 3 to 5.
"""

from __future__ import annotations

import logging
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
from placecue.extraction import Extraction
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.integrator import Integrator, OnlyCue
from placecue.learning.held_out import HeldOut
from placecue.learning.rejection import Rejection, Unknown
from placecue.learning.samples import Samples, collect
from placecue.learning.training import train
from placecue.observation import PARTS, Observation, Part
from placecue.progress import track
from placecue.scores import Probabilities
from placecue.semantic_map import UNKNOWN
from placecue.skipped import Skipped

log = logging.getLogger(__name__)


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
    unknown : Unknown, optional
        Call decisions that are not sure enough "unknown"; without it every belief names a class.

    Attributes
    ----------
    extraction : Extraction
        How features come from observations: straight from the cues, unless one sets a cache here.
    on_error : {"stop", "skip"}
        What becomes of an observation that a component fails on.
    rejection_ : Rejection or None
        The threshold below which a decision is "unknown", chosen by :meth:`fit`.
    held_out_ : HeldOut or None
        Scores that :meth:`fit` made of samples which the single-cue models have not seen, where
        it needed them; not saved with a model.

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
        unknown: Unknown | None = None,
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
        self.unknown = unknown
        self.extraction = Extraction()
        self.on_error = "stop"
        self.rejection_: Rejection | None = None
        self.held_out_: HeldOut | None = None

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
        evidence = ObservedEvidence(observations, self.cues, self.extraction)  # extract, score
        scores = self.integrator.integrate(evidence)  # integrate
        decision = scores.decide()  # decide
        labels = decision.labels if self.rejection_ is None else self.rejection_.labels(decision)
        return [
            Belief(
                stamp=observation.stamp,
                scores=scores[row : row + 1],
                label=str(labels[row]),
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
        *,
        reliability: bool = False,
    ) -> Self:
        """Train the single-cue models, then the integrator on scores that they have not seen.

        Where "unknown" is asked for, its threshold is chosen last, on decisions that neither the
        single-cue models nor the integrator have seen.

        Parameters
        ----------
        observations : iterable of Observation
            Labelled observations.
        integration : iterable of Observation, optional
            Labelled observations of another sequence to fit the integrator and choose the
            threshold for "unknown" on. Without them out-of-fold scores of ``observations`` serve.
        reliability : bool
            Set :attr:`held_out_` also for the sake of a reliability diagram alone: where a single
            cue gives probabilities and no "unknown" is asked for.

        Raises
        ------
        DataError
            If there are no labels, fewer than two classes, a class of one sample, or one called
            "unknown" where that is to be said of what is none of the classes.
        """
        samples = self._collect(observations)
        _check_classes(samples)
        self._check_names(samples)
        self.rejection_ = self.held_out_ = None
        for name, (cue, classifier) in track(self.cues.items(), "training", len(self.cues)):
            learned_from = None
            if cue.learns:
                samples.fit(cue)
                learned_from = partial(samples.learned_from, name, cue)
            of_cue = samples.of_cue(name, cue)
            train(classifier, of_cue, samples.labels, samples.stamps, learned_from=learned_from)
        if not self._needs_held_out(reliability):
            if integration is not None:
                log.warning(
                    "the integration log is not used: one cue needs no integration, and neither "
                    "'unknown' nor probabilities are asked for"
                )
            return self
        held_out, foreign = self._held_out(samples, integration)
        self.integrator.fit(held_out.evidence, held_out.labels, held_out.stamps)
        if self.unknown is not None:
            rate = self.unknown.false_accept_rate
            self.rejection_ = held_out.rejection(self.integrator, self.folds, rate, foreign)
        self.held_out_ = held_out
        return self

    def _needs_held_out(self, reliability: bool) -> bool:
        if not isinstance(self.integrator, OnlyCue) or self.unknown is not None:
            return True
        layouts = [classifier.layout_ for _, classifier in self.cues.values()]
        return reliability and any(isinstance(each, Probabilities) for each in layouts)

    def _check_names(self, samples: Samples) -> None:
        if self.unknown is not None and UNKNOWN in samples.labels:
            raise DataError(
                f"there are samples of a class called '{UNKNOWN}', which with false_accept_rate is "
                f"the name of what is none of the classes: drop or rename it (label_map="
                f"{{{UNKNOWN}: null}}), or leave out unknown.false_accept_rate"
            )

    def _collect(self, observations: Iterable[Observation]) -> Samples:
        cues = {name: cue for name, (cue, _) in self.cues.items()}
        return collect(observations, cues, self.extraction)

    def _out_of_fold(self, samples: Samples) -> tuple[Evidence, Rows]:
        out_of_fold = OutOfFold(self.folds)
        scores = {}
        for name, (cue, classifier) in self.cues.items():
            learned = partial(samples.learned_from, name, cue)
            features = learned if cue.learns else samples.of_cue(name, cue)
            scores[name] = out_of_fold.scores(
                classifier, features, samples.labels, samples.stamps, what=name
            )
        rows = scored_rows(scores)
        return StoredEvidence({name: of_cue[rows] for name, of_cue in scores.items()}), rows

    def _held_out(
        self, samples: Samples, integration: Iterable[Observation] | None
    ) -> tuple[HeldOut, HeldOut | None]:
        """Return what the single-cue models have not seen, and samples of other places, if any."""
        if integration is None:
            evidence, rows = self._out_of_fold(samples)
            return HeldOut(evidence, samples.labels[rows], samples.stamps[rows]), None
        unseen = self._collect(integration)
        self._check_names(unseen)
        every = HeldOut(self._scored(unseen), unseen.labels, unseen.stamps)
        held_out, foreign = every.parted(self.classes)
        self._check_integration(held_out, foreign)
        return held_out, foreign

    def _check_integration(self, unseen: HeldOut, foreign: HeldOut | None) -> None:
        missing = set(self.classes) - set(unseen.labels.tolist())
        if missing and not isinstance(self.integrator, OnlyCue):
            raise DataError(
                f"the integration log has no sample of {', '.join(sorted(missing))}: an integrator "
                "fitted on it would never say so; give a log with every class of the training log"
            )
        if foreign is not None and self.unknown is None:
            names = ", ".join(sorted(set(foreign.labels.tolist())))
            log.warning(
                f"{len(foreign.labels)} samples of the integration log are left out: {names} is no "
                "class of the training log"
            )

    def _scored(self, samples: Samples) -> Evidence:
        return StoredEvidence(
            {
                name: classifier.scores(samples.of_cue(name, cue).features)
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
