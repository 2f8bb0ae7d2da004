"""The scores of all cues for a batch of observations, computed when they are asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.classifier import Classifier
from placecue.cue import Cue
from placecue.errors import DataError, UsageError, choices
from placecue.extraction import Extraction
from placecue.features import take
from placecue.folds import FoldScheme, Rows
from placecue.learning.samples import CueSamples, LearnedFrom
from placecue.learning.training import train
from placecue.observation import Observation
from placecue.progress import track
from placecue.scores import Layout, Scores

#: The cues of a pipeline, each with its classifier, in order of cost.
CueModels: TypeAlias = Mapping[str, tuple[Cue, Classifier]]


class Evidence(ABC):
    """The scores of all cues for n observations.

    Attributes
    ----------
    cues : tuple of str
        The names of the cues.
    """

    cues: tuple[str, ...]

    @abstractmethod
    def __len__(self) -> int:
        """Return the number of observations."""

    @abstractmethod
    def layout(self, cue: str) -> Layout:
        """Return the layout of a cue's scores, without computing any."""

    @abstractmethod
    def scores(self, cue: str, rows: Sequence[int] | Rows | None = None) -> Scores:
        """Return a cue's scores for the given rows (all by default), computing what is missing."""

    @abstractmethod
    def used(self, row: int) -> tuple[str, ...]:
        """Return the cues that have been asked about one observation so far."""


class StoredEvidence(Evidence):
    """Evidence that is there already.

    Parameters
    ----------
    scores : mapping of str to Scores
        For each cue the scores of the same n observations.
    """

    def __init__(self, scores: Mapping[str, Scores]) -> None:
        lengths = {name: len(of_cue) for name, of_cue in scores.items()}
        if len(set(lengths.values())) != 1:
            raise UsageError(f"the cues' scores must be of the same observations, got {lengths}")
        self.cues = tuple(scores)
        self._scores = dict(scores)

    def __len__(self) -> int:
        return len(next(iter(self._scores.values())))

    def layout(self, cue: str) -> Layout:  # noqa: D102
        return self._of(cue).layout

    def scores(self, cue: str, rows: Sequence[int] | Rows | None = None) -> Scores:  # noqa: D102
        of_cue = self._of(cue)
        return of_cue if rows is None else of_cue[rows]

    def used(self, row: int) -> tuple[str, ...]:  # noqa: D102
        return self.cues

    def _of(self, cue: str) -> Scores:
        if cue not in self._scores:
            raise UsageError(f"there is no evidence of cue '{cue}'; {choices(cue, self.cues)}")
        return self._scores[cue]


class ObservedEvidence(Evidence):
    """Evidence that is extracted and scored from observations on demand, each part once.

    Parameters
    ----------
    observations : sequence of Observation
        The batch.
    models : mapping of str to (Cue, Classifier)
        The fitted cues.
    extraction : Extraction, optional
        How features come from observations; by default straight from the cues.
    """

    def __init__(
        self,
        observations: Sequence[Observation],
        models: CueModels,
        extraction: Extraction | None = None,
    ) -> None:
        self.cues = tuple(models)
        self._extraction = Extraction() if extraction is None else extraction
        self._observations = observations
        self._models = models
        self._values: dict[str, NDArray[np.float64]] = {}
        self._known: dict[str, NDArray[np.bool_]] = {}

    def __len__(self) -> int:
        return len(self._observations)

    def layout(self, cue: str) -> Layout:  # noqa: D102
        return self._model(cue)[1].layout_

    def scores(self, cue: str, rows: Sequence[int] | Rows | None = None) -> Scores:  # noqa: D102
        extractor, classifier = self._model(cue)
        rows = np.arange(len(self)) if rows is None else np.asarray(rows)
        n_columns = len(classifier.layout_.columns)
        known = self._known.setdefault(cue, np.zeros(len(self), dtype=bool))
        values = self._values.setdefault(cue, np.empty((len(self), n_columns)))
        fresh = rows[~known[rows]]
        if fresh.size:
            asked = [self._observations[row] for row in fresh]
            features = self._extraction.transform(extractor, asked)
            values[fresh] = classifier.scores(features).values
            known[fresh] = True
        return Scores(values[rows], classifier.layout_)

    def used(self, row: int) -> tuple[str, ...]:  # noqa: D102
        return tuple(cue for cue in self.cues if cue in self._known and self._known[cue][row])

    def _model(self, cue: str) -> tuple[Cue, Classifier]:
        if cue not in self._models:
            raise UsageError(f"there is no cue '{cue}'; {choices(cue, self.cues)}")
        return self._models[cue]


class OutOfFold:
    """Scores that each sample gets from a classifier which has not seen it.

    An integrator fitted on scores of the very samples that the single-cue models were trained on
    trusts whichever cue overfits most.

    Parameters
    ----------
    folds : FoldScheme
        How the samples are cut.
    """

    def __init__(self, folds: FoldScheme) -> None:
        self.folds = folds

    def scores(
        self,
        classifier: Classifier,
        samples: CueSamples | LearnedFrom,
        labels: NDArray[np.str_],
        stamps: ArrayLike | None = None,
        *,
        what: str = "cue",
    ) -> Scores:
        """Return the out-of-fold scores of one cue.

        Parameters
        ----------
        classifier : Classifier
            A fitted classifier; copies with its chosen parameters are fitted in each fold.
        samples : CueSamples, or callable
            The features of all n samples by a cue that learns nothing; of one that learns, what
            returns them given the training rows of a fold, from which alone the cue has learned.
            Altered copies are trained on and never scored.
        labels : ndarray of str, shape (n,)
            The classes of the samples.
        stamps : array of int, shape (n,), optional
            Their times, ns.
        what : str
            The name of the cue, for progress and messages.

        Returns
        -------
        Scores
            Shape (n, V) in the fitted classifier's layout; NaN for a sample that no fold held out.
        """
        values = np.full((len(labels), len(classifier.layout_.columns)), np.nan)
        times = None if stamps is None else np.asarray(stamps)
        splits = track(list(self.folds.split(labels, times)), f"{what}: out-of-fold scores")
        if isinstance(samples, CueSamples) and not samples.altered:
            scored = classifier.out_of_fold(samples.features, labels, times, splits)
        else:
            scored = _fitted_anew(classifier, samples, labels, times, splits)
        for held_out, scores in scored:
            values[held_out] = scores
        return Scores(values, classifier.layout_)


def _fitted_anew(
    classifier: Classifier,
    samples: CueSamples | LearnedFrom,
    labels: NDArray[np.str_],
    stamps: NDArray[np.int64] | None,
    splits: Iterable[tuple[Rows, Rows]],
) -> Iterator[tuple[Rows, NDArray[np.float64]]]:
    """Yield held-out rows with their scores; each fold has features and copies of its own."""
    learned_from = None if isinstance(samples, CueSamples) else samples
    for training, held_out in splits:
        of_fold = samples if isinstance(samples, CueSamples) else samples(training)
        copy = train(classifier.chosen(), of_fold, labels, stamps, training, learned_from)
        yield held_out, copy.scores(take(of_fold.features, held_out)).values


def scored_rows(evidence: Mapping[str, Scores]) -> Rows:
    """Return the rows for which every cue has scores.

    Raises
    ------
    DataError
        If there are none.
    """
    known = [~np.isnan(scores.values).any(axis=1) for scores in evidence.values()]
    rows = np.flatnonzero(np.logical_and.reduce(known))
    if rows.size == 0:
        raise DataError("no sample has out-of-fold scores: give more training samples")
    return rows.astype(np.int64)
