"""The path of one observation, in the paper's order: extract, score, integrate, decide, accumulate.

The paper: Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place classification,
IJRR 29(2-3), 2010, sections 3 to 5.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from itertools import combinations
from typing import Self

import numpy as np

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.checks import check_choice, check_whole
from placecue.classifier import Classifier
from placecue.contracts import area_update
from placecue.cue import Cue
from placecue.cue_model import CueModel
from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.evidence import ObservedEvidence, StoredEvidence
from placecue.extraction import Extraction, batched
from placecue.faults import Faults, MissingCues
from placecue.folds import FoldScheme, InterleavedChunks
from placecue.guard import call
from placecue.held_out import HeldOut, check_unseen
from placecue.integration import unfitted
from placecue.integrator import Integrator, OnlyCue
from placecue.learning.calibration import Calibration, calibrated
from placecue.learning.collecting import collect
from placecue.learning.costs import measured
from placecue.learning.judging import (
    Judged,
    judged_by,
    judged_by_copies,
    judged_by_integrators,
)
from placecue.learning.rejection import Rejection, Unknown, choose_threshold
from placecue.learning.samples import Samples
from placecue.observation import PARTS, Observation, Part
from placecue.progress import track
from placecue.schemes import Cues, Schemes, sets_of
from placecue.scores import Layout, Probabilities, Scores
from placecue.semantic_map import UNKNOWN
from placecue.source import guarded

#: What becomes of an observation at which a component fails.
ON_ERROR = ("stop", "skip")

log = logging.getLogger(__name__)


class Pipeline:
    """Cues with their classifiers, and an integrator.

    Parameters
    ----------
    cues : mapping of str to CueModel or (Cue, Classifier)
        The cues by name, in order of cost, each with its classifier.
    integrator : Integrator, optional
        Joins the cues; may be left out where there is one cue.
    folds : FoldScheme, optional
        How the training samples are cut, wherever some are held out: to fit the integrator on
        scores that the single-cue models have not seen, and in every classifier that has no
        scheme of its own. Interleaved chunks of 2 s by default.
    unknown : Unknown, optional
        Call decisions that are not sure enough "unknown"; without it every belief names a class.

    Attributes
    ----------
    extraction : Extraction
        How features come from observations: straight from the cues, unless one sets a cache here.
    pool : Executor or None
        Threads in which the cues of a batch go side by side, such as camera and laser; None: one
        after the other. Not together with a feature cache, which is for one thread.
    on_error : {"stop", "skip"}
        What becomes of an observation at which a component fails: the error, or the cue is missing
        there; an observation without any is passed over and counted.
    min_cues : int
        An observation that has fewer cues is passed over.
    for_fewer_ : dict of tuple of str to Integrator
        Copies of the integrator for where cues are missing, fitted by :meth:`fit`.
    layout_ : Layout or None
        That of the integrated scores.
    rejection_ : Rejection or None
        The threshold below which a decision is "unknown", chosen by :meth:`fit`.
    calibration_ : Calibration or None
        How much the integrated scores say, learned by :meth:`fit` on held-out samples.
    held_out_ : HeldOut or None
        Scores of samples which the single-cue models have not seen, on which :meth:`fit` fitted
        the integrator, where there was one; not saved with a model.
    judged_ : list of Judged or None
        Scores held out of everything, where :meth:`fit` needed them; not saved with a model.

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
        cues: Mapping[str, CueModel | tuple[Cue, Classifier]],
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
        self.cues = {name: CueModel.of(model) for name, model in cues.items()}
        self.integrator = OnlyCue() if integrator is None else integrator
        call(self.integrator, "check_cues", tuple(self.cues))
        self.folds = InterleavedChunks() if folds is None else folds
        self.unknown = unknown
        self.extraction = Extraction()
        self.pool: Executor | None = None
        self.on_error = "stop"
        self.min_cues = 1
        self.for_fewer_: dict[Cues, Integrator] = {}
        self.layout_: Layout | None = None
        self.rejection_: Rejection | None = None
        self.calibration_: Calibration | None = None
        self.held_out_: HeldOut | None = None
        self.judged_: list[Judged] | None = None

    # ------------------------------------------------------------------ one observation

    def believe(self, observations: Sequence[Observation]) -> list[Belief]:
        """Say what kind of place each observation shows.

        Parameters
        ----------
        observations : sequence of Observation
            A batch; cues are extracted only as far as the integrator asks for them. Where one is
            missing the others are integrated without it.

        Returns
        -------
        list of Belief
            One an observation.

        Raises
        ------
        UnusableObservation
            If one of them has no cue, or fewer than :attr:`min_cues`.
        """
        beliefs = []
        for belief in self._beliefs(observations, MissingCues()):
            if isinstance(belief, UnusableObservation):
                raise belief
            beliefs.append(belief)
        return beliefs

    def _beliefs(
        self, observations: Sequence[Observation], missing: MissingCues
    ) -> Iterator[Belief | UnusableObservation]:
        """Yield the belief of each observation, or why there is none; count missing cues."""
        evidence = ObservedEvidence(  # extract, score
            observations, self.cues, self.extraction, skip=self.skips
        )
        if self.pool is not None and not self.schemes.full.stops_early:
            evidence.compute(self.pool)
        scores, failed = self.schemes.integrate(  # integrate
            evidence, observations, skip=self.skips
        )
        known = evidence.known()
        there = np.flatnonzero(scores.available() & (known.sum(axis=1) >= self.least))
        decision = scores[there].decide()  # decide
        labels = decision.labels if self.rejection_ is None else self.rejection_.labels(decision)
        decided = dict(zip(there.tolist(), range(len(there)), strict=True))
        worth = self.calibration_
        # Of cues that are asked only where others are unsure, agreement says nothing.
        agreement = None if worth is None or self.schemes.full.stops_early else worth.agreement
        for row, observation in enumerate(observations):
            lacking = [cue for cue, has in zip(evidence.cues, known[row], strict=True) if not has]
            if row not in decided:
                yield failed.get(row) or self._too_few(evidence, row, lacking)
                continue
            for cue in lacking:
                missing.add(cue, evidence.why(cue, row))
            yield Belief(
                stamp=observation.stamp,
                scores=scores[row : row + 1].read_only(),
                label=str(labels[decided[row]]),
                confidence=float(decision.confidence[decided[row]]),
                cue_scores=evidence.scores_at(row),
                cues_missing=tuple(lacking),
                sharpness=None if worth is None else worth.sharpness,
                agreement=agreement,
            )

    def _too_few(
        self, evidence: ObservedEvidence, row: int, lacking: Sequence[str]
    ) -> UnusableObservation:
        """Return why too few cues are there to tell anything of an observation."""
        if not lacking:
            return evidence.reason(row)
        why = evidence.why(lacking[0], row)
        if len(lacking) == len(self.cues):
            return why
        error = UnusableObservation(
            f"{len(self.cues) - len(lacking)} of {len(self.cues)} cues, where min_cues asks for "
            f"{self.least}: {why}"
        )
        error.__cause__ = why
        return error

    def label(
        self, observations: Iterable[Observation], accumulator: Accumulator, batch: int = 1
    ) -> Iterator[tuple[Observation, Belief | None, AreaUpdate | None]]:
        """Follow a log through to labelled areas, in one pass.

        Yields each observation with its belief (None where it was unusable) and what the
        accumulator made of it; ``accumulator.semantic_map()`` is the map so far.
        """
        for observation, belief in self.follow(observations, batch):
            if observation.correction is not None:
                call(accumulator, "corrected", observation.correction, at=observation)
            update = call(  # accumulate
                accumulator, "update", observation, belief, check=area_update, at=observation
            )
            yield observation, belief, update
        call(accumulator, "finish")

    # ------------------------------------------------------------------ a log

    def follow(
        self, observations: Iterable[Observation], batch: int = 1
    ) -> Iterator[tuple[Observation, Belief | None]]:
        """Pair each observation with its belief, None where it was unusable.

        What was passed over is reported once, at the end, and which cues were missing how often.

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
        faults, missing, total = Faults(), MissingCues(), 0
        for group in batched(guarded(observations), batch):
            total += len(group)
            for observation, belief in zip(group, self._beliefs(group, missing), strict=True):
                if isinstance(belief, UnusableObservation):
                    faults.pass_over(belief)
                    yield observation, None
                else:
                    yield observation, belief
        if total == 0:
            raise DataError("the log holds no observation")
        faults.report_of(total)
        missing.report(total)

    def beliefs(self, observations: Iterable[Observation], batch: int = 1) -> Iterator[Belief]:
        """Yield the belief of each usable observation; see :meth:`follow`."""
        return (belief for _, belief in self.follow(observations, batch) if belief is not None)

    # ------------------------------------------------------------------ training

    def fit(
        self,
        observations: Iterable[Observation],
        integration: Iterable[Observation] | None = None,
        *,
        reliability: bool = False,
        force_training_scores: bool = False,
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
            Learn :attr:`calibration_`, and set :attr:`judged_` also for the sake of a reliability
            diagram alone: where a cue or the integrator gives probabilities and no "unknown" is
            asked for.
        force_training_scores : bool
            Fit the integrator even on scores of samples that the single-cue models were trained
            on, which are better than those of others will be.

        Raises
        ------
        UsageError
            If the integration log holds observations that were trained on, unless that is forced.
        DataError
            If there are no labels, fewer than two classes, a class of one sample, or one called
            "unknown" where that is to be said of what is none of the classes.
        """
        samples = self.collect(observations)
        _check_classes(samples)
        self.rejection_ = self.calibration_ = self.held_out_ = self.judged_ = None
        self.fit_cues(samples)
        judges = self.unknown is not None or (reliability and self._tells_probabilities())
        unseen = foreign = None
        if integration is not None and (self.integrates or judges):
            unseen, foreign = self._unseen(integration, force_training_scores)
        elif integration is not None:
            log.warning(
                "the integration log is not used: one cue needs no integration, and neither "
                "'unknown' nor probabilities are asked for"
            )
        self.held_out_ = unseen
        if self.integrates:
            self.held_out_ = self.held_out(samples) if unseen is None else unseen
            self.fit_integrator(self.held_out_, force_training_scores=force_training_scores)
            judges |= reliability and self._tells_probabilities()
        if judges:
            self.judged_ = self._judged(samples, unseen)
        if reliability:
            self.calibration_ = self._calibrated(samples)
        if self.unknown is not None and self.judged_ is not None:
            judged = list(self.judged_)
            if foreign is not None:
                judged.append(judged_by(self.schemes, foreign, skip=self.skips))
            self.fit_rejection(judged)
        return self

    def collect(self, observations: Iterable[Observation]) -> Samples:
        """Read labelled observations and extract every cue that learns nothing, for the fits."""
        cues = {name: model.cue for name, model in self.cues.items()}
        samples = collect(
            observations,
            cues,
            self.extraction,
            self.folds,
            skip=self.skips,
            min_cues=self.least,
        )
        self._check_names(samples)
        return samples

    def fit_cues(self, samples: Samples) -> Self:
        """Train the single-cue models; a cue that learns is fitted first.

        Parameters
        ----------
        samples : Samples
            What :meth:`collect` returned.
        """
        for name, model in track(self.cues.items(), "training", len(self.cues)):
            model.fit(samples.training_set(name, model.cue))
            model.trained_on = samples.which()
        return self

    def held_out(self, samples: Samples) -> HeldOut:
        """Return scores of the training samples by copies of the models that have not seen them.

        What an integrator is fitted on. Cues are not trained again for a second integrator:
        ``Pipeline(first.cues, other).fit_integrator(held_out)``.

        Raises
        ------
        DataError
            If no fold holds samples out.
        """
        scores = {}
        for name, model in self.cues.items():
            training = samples.training_set(name, model.cue)
            unseen = model.held_out(training, self.folds, name=name)
            scores[name] = unseen.spread(samples.trained_on(name, model.cue), len(samples))
        held_out = self._with_some(samples, StoredEvidence(scores))
        if held_out is None:
            raise DataError("no sample has out-of-fold scores: give more training samples")
        return held_out

    def fit_integrator(self, held_out: HeldOut, *, force_training_scores: bool = False) -> Self:
        """Fit the integrator on scores that the single-cue models have not been trained on.

        Copies of it are fitted for where cues are missing; see :class:`placecue.Schemes`.

        Raises
        ------
        UsageError
            If they are known to have been trained on some of the samples, unless that is forced.
        """
        if not force_training_scores:
            check_unseen(held_out)
        schemes = Schemes.fit(self.integrator, held_out, self._sets())
        self.for_fewer_ = {
            cues: scheme
            for cues, scheme in schemes.by_cues.items()
            if scheme is not self.integrator
        }
        self.layout_ = schemes.layout
        return self

    def fit_rejection(self, judged: Sequence[Judged]) -> Self:
        """Choose the threshold for "unknown" on decisions held out of everything."""
        if self.unknown is None:
            raise UsageError("no 'unknown' is asked for: give unknown=Unknown(false_accept_rate)")
        confidence, correct = zip(*(each.decisions() for each in judged), strict=True)
        self.rejection_ = choose_threshold(
            np.concatenate(confidence), np.concatenate(correct), self.unknown.false_accept_rate
        )
        return self

    def evidence_of(self, samples: Samples) -> StoredEvidence:
        """Return the scores of labelled samples, NaN where there are none.

        The evidence knows which of them the single-cue models were trained on.
        """
        scores = {}
        for name, model in self.cues.items():
            found = samples.features(name, model.cue)
            if found.features is None:
                nothing = np.empty((0, len(model.layout.columns)))
                scored = Scores(nothing, model.layout)
            else:
                scored = model.tried(found.features, skip=self.skips)
            scores[name] = scored.spread(found.rows, len(samples))
        known = [model.trained_on for model in self.cues.values() if model.trained_on is not None]
        seen = [samples.which().among(each) for each in known]
        return StoredEvidence(scores, np.logical_or.reduce(seen) if seen else None)

    def _with_some(self, samples: Samples, evidence: StoredEvidence) -> HeldOut | None:
        """Return the samples with scores of a cue or more; None where there is none."""
        cut = samples.labels, samples.stamps, samples.groups
        held_out = HeldOut(evidence, *cut, self.folds, part=True, costs=self._costs(samples))
        known = evidence.known().any(axis=1)
        if not known.any():
            return None
        return held_out if known.all() else held_out.take(np.flatnonzero(known))

    def _costs(self, samples: Samples) -> dict[str, float] | None:
        """Return what each cue takes, ms a sample, where the integrator wants to be told."""
        return measured(self.cues, samples.reread()) if self.integrator.wants_costs else None

    def _sets(self) -> list[Cues]:
        """Return the sets of cues that there are to be schemes for."""
        needs = {name: set(model.cue.requires) for name, model in self.cues.items()}
        some = (set(parts) for n in range(len(PARTS)) for parts in combinations(PARTS, n))
        together = [tuple(name for name, need in needs.items() if need <= have) for have in some]
        return sets_of(tuple(self.cues), together)

    def unfitted(self) -> Pipeline:
        """Return a copy that has learned nothing, with the same parameters and extraction."""
        cues = {name: model.unfitted() for name, model in self.cues.items()}
        copy = Pipeline(cues, unfitted(self.integrator), self.folds, self.unknown)
        copy.extraction, copy.on_error = self.extraction, self.on_error
        copy.min_cues = self.min_cues
        return copy

    @property
    def schemes(self) -> Schemes:
        """The integrator, and its copies for where cues are missing."""
        return Schemes({tuple(self.cues): self.integrator, **self.for_fewer_}, self.layout_)

    @property
    def least(self) -> int:
        """How many cues an observation must have, checked."""
        check_whole("min_cues", self.min_cues, least=1)
        if self.min_cues > len(self.cues):
            raise UsageError(
                f"min_cues is {self.min_cues}, and there are {len(self.cues)} cues "
                f"({', '.join(self.cues)}): give at most {len(self.cues)}"
            )
        return self.min_cues

    @property
    def integrates(self) -> bool:
        """Whether there is anything to integrate."""
        return not isinstance(self.integrator, OnlyCue)

    @property
    def skips(self) -> bool:
        """Whether an observation at which a component fails is passed over."""
        check_choice("on_error", self.on_error, ON_ERROR)
        return self.on_error == "skip"

    def _judged(self, samples: Samples, held_out: HeldOut | None) -> list[Judged]:
        if held_out is None:
            return judged_by_copies(self, samples)
        if not self.integrates:
            return [judged_by(self.schemes, held_out, skip=self.skips)]
        return judged_by_integrators(self.integrator, held_out, self._sets(), skip=self.skips)

    def _calibrated(self, samples: Samples) -> Calibration | None:
        """Learn how much scores say; None, and a word on it, where nothing can be held out."""
        try:
            return calibrated(self.judged_ or self._judged_cheaply(samples))
        except DataError as error:
            log.warning(f"how probable decisions are is not measured: {error}")
            return None

    def _judged_cheaply(self, samples: Samples) -> list[Judged]:
        """Judge on scores held out of the single-cue models, integrated by copies in folds.

        Their parameters were chosen on these samples too, which flatters a little.
        """
        held_out = self.held_out(samples) if self.held_out_ is None else self.held_out_
        if not self.integrates:
            return [judged_by(self.schemes, held_out, skip=self.skips)]
        every = [tuple(self.cues)]
        return judged_by_integrators(self.integrator, held_out, every, skip=self.skips)

    def _tells_probabilities(self) -> bool:
        """Tell whether a cue, or the fitted integrator, gives probabilities."""
        layouts = [model.layout for model in self.cues.values()]
        if self.held_out_ is not None and self.integrates:
            one = self.held_out_.take(np.array([0]))
            layouts.append(judged_by(self.schemes, one, skip=self.skips).scores.layout)
        return any(isinstance(layout, Probabilities) for layout in layouts)

    def _check_names(self, samples: Samples) -> None:
        if self.unknown is not None and UNKNOWN in samples.labels:
            raise DataError(
                f"there are samples of a class called '{UNKNOWN}', which with false_accept_rate is "
                f"the name of what is none of the classes: drop or rename it (label_map="
                f"{{{UNKNOWN}: null}}), or leave out unknown.false_accept_rate"
            )

    def _unseen(
        self, observations: Iterable[Observation], force_training_scores: bool
    ) -> tuple[HeldOut, HeldOut | None]:
        """Return the evidence of another sequence, and that of other places in it, if any."""
        unseen = self.collect(observations)
        every = self._with_some(unseen, self.evidence_of(unseen))
        if every is None:
            raise DataError("no sample of the integration log has scores of a cue")
        if not force_training_scores:
            check_unseen(every)
        held_out, foreign = every.parted(self.classes)
        missing = set(self.classes) - set(held_out.labels.tolist())
        if missing and self.integrates:
            raise DataError(
                f"the integration log has no sample of {', '.join(sorted(missing))}: an integrator "
                "fitted on it would never say so; give a log with every class of the training log"
            )
        if foreign is not None and self.unknown is None:
            names = ", ".join(sorted(set(foreign.labels.tolist())))
            log.warning(
                f"{len(foreign)} samples of the integration log are left out: {names} is no "
                "class of the training log"
            )
        return held_out, foreign

    @property
    def requires(self) -> tuple[Part, ...]:
        """The parts of an observation that the cues need."""
        needed = {part for model in self.cues.values() for part in model.cue.requires}
        return tuple(part for part in PARTS if part in needed)

    @property
    def classes(self) -> tuple[str, ...]:
        """The classes that the pipeline tells apart, sorted; empty before it is fitted."""
        model = next(iter(self.cues.values()))
        layout = getattr(model.classifier, "layout_", None)
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
