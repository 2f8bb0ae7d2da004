"""The scores of all cues for a batch of observations, computed when they are asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from placecue.attempts import attempt
from placecue.cue_model import CueModel
from placecue.errors import UnusableObservation, UsageError, choices
from placecue.extraction import Extraction
from placecue.features import take
from placecue.folds import Rows
from placecue.observation import Observation
from placecue.read_only import read_only
from placecue.scores import Layout, Scores

#: Some of n observations: their numbers, or a mask.
Some: TypeAlias = Sequence[int] | NDArray[np.integer] | NDArray[np.bool_]


class Evidence(ABC):
    """The scores of all cues for n observations.

    A cue may be missing for some of them: then its row of scores is NaN, and
    :meth:`available` says so.

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
    def scores(self, cue: str) -> Scores:
        """Return a cue's scores, shape (n, V), computing what is missing; NaN where it cannot."""

    @abstractmethod
    def available(self, cue: str) -> NDArray[np.bool_]:
        """Return for which observations a cue has scores, as far as is known, shape (n,).

        Before they are computed that is where its parts are there.
        """

    @abstractmethod
    def used(self, row: int) -> tuple[str, ...]:
        """Return the cues that one observation has scores of so far."""

    @abstractmethod
    def take(self, rows: Some) -> Evidence:
        """Return the evidence of the given observations; what it computes is kept here too."""

    @abstractmethod
    def only(self, cues: Sequence[str]) -> Evidence:
        """Return the evidence of the given cues; what it computes is kept here too.

        Raises
        ------
        UsageError
            If there is no such cue.
        """

    def trained_on(self) -> NDArray[np.bool_]:
        """Return which observations the models that give the scores were trained on, shape (n,)."""
        return np.zeros(len(self), dtype=bool)

    def known(self) -> NDArray[np.bool_]:
        """Return which cues each observation has as far as is known, shape (n, T)."""
        return np.stack([self.available(cue) for cue in self.cues], axis=1)


class StoredEvidence(Evidence):
    """Evidence that is there already.

    Parameters
    ----------
    scores : mapping of str to Scores
        For each cue the scores of the same n observations; a row of NaN where it is missing.
    trained_on : ndarray of bool, shape (n,), optional
        Which of them the models that gave the scores were trained on; none by default.

    Raises
    ------
    UsageError
        If there is no cue, or the scores are of different numbers of observations.
    """

    def __init__(
        self, scores: Mapping[str, Scores], trained_on: NDArray[np.bool_] | None = None
    ) -> None:
        lengths = {name: len(of_cue) for name, of_cue in scores.items()}
        if not lengths:
            raise UsageError("no scores of any cue: give those of one or more")
        if len(set(lengths.values())) != 1:
            raise UsageError(f"the cues' scores must be of the same observations, got {lengths}")
        self.cues = tuple(scores)
        self._scores = dict(scores)
        self._trained_on = trained_on
        self._known: NDArray[np.bool_] | None = None

    def __len__(self) -> int:
        return len(next(iter(self._scores.values())))

    def trained_on(self) -> NDArray[np.bool_]:  # noqa: D102
        return super().trained_on() if self._trained_on is None else self._trained_on

    def layout(self, cue: str) -> Layout:  # noqa: D102
        return self.scores(cue).layout

    def scores(self, cue: str) -> Scores:  # noqa: D102
        if cue not in self._scores:
            raise UsageError(f"there is no evidence of cue '{cue}'; {choices(cue, self.cues)}")
        return self._scores[cue]

    def available(self, cue: str) -> NDArray[np.bool_]:  # noqa: D102
        return self.scores(cue).available()

    def known(self) -> NDArray[np.bool_]:  # noqa: D102
        if self._known is None:
            self._known = read_only(super().known())
        return self._known

    def used(self, row: int) -> tuple[str, ...]:  # noqa: D102
        return tuple(cue for cue in self.cues if self._scores[cue][[row]].available().all())

    def take(self, rows: Some) -> StoredEvidence:  # noqa: D102
        some = _some(rows, len(self))
        scores = {cue: of_cue[some] for cue, of_cue in self._scores.items()}
        return StoredEvidence(scores, self.trained_on()[some])

    def only(self, cues: Sequence[str]) -> StoredEvidence:  # noqa: D102
        return StoredEvidence({cue: self.scores(cue) for cue in cues}, self._trained_on)


class ObservedEvidence(Evidence):
    """Evidence that is extracted and scored from observations on demand, each part once.

    Parameters
    ----------
    observations : sequence of Observation
        The batch.
    models : mapping of str to CueModel
        The fitted cues with their classifiers.
    extraction : Extraction, optional
        How features come from observations; by default straight from the cues.
    skip : bool
        Whether an observation at which a component fails counts as unusable.

    Attributes
    ----------
    failed : dict of (str, int) to UnusableObservation
        Why a cue has no scores of an observation, by cue and row, where it was asked about it.
    """

    def __init__(
        self,
        observations: Sequence[Observation],
        models: Mapping[str, CueModel],
        extraction: Extraction | None = None,
        *,
        skip: bool = False,
    ) -> None:
        self.cues = tuple(models)
        self._skip = skip
        self.failed: dict[tuple[str, int], UnusableObservation] = {}
        self._extraction = Extraction() if extraction is None else extraction
        self._observations = observations
        self._models = models
        self._values: dict[str, NDArray[np.float64]] = {}
        self._asked: dict[str, NDArray[np.bool_]] = {}

    def __len__(self) -> int:
        return len(self._observations)

    def layout(self, cue: str) -> Layout:  # noqa: D102
        return self._model(cue).layout

    def scores(self, cue: str) -> Scores:  # noqa: D102
        return self.scores_of(cue, np.arange(len(self)))

    def scores_of(self, cue: str, rows: Rows) -> Scores:
        """Return a cue's scores of the given observations, computing what is missing."""
        model = self._model(cue)
        shape = len(self), len(model.layout.columns)
        asked = self._asked.setdefault(cue, np.zeros(len(self), dtype=bool))
        values = self._values.setdefault(cue, np.full(shape, np.nan))
        fresh = rows[~asked[rows]]
        if fresh.size:
            self._compute(cue, model, fresh)
            asked[fresh] = True
        return Scores(values[rows], model.layout)

    def compute(self, pool: Executor) -> None:
        """Compute the scores of all cues side by side, where their parts are there.

        Parameters
        ----------
        pool : Executor
            Of threads; each cue is asked by one of them.
        """
        image = [cue for cue in self.cues if "image" in self._model(cue).cue.requires]
        others = [cue for cue in self.cues if cue not in image]
        started = [pool.submit(self._compute_there, cue) for cue in others]
        if len(image) > 1:
            self._decode()  # once, and not in each thread
        started += [pool.submit(self._compute_there, cue) for cue in image]
        for each in started:
            each.result()

    def _compute_there(self, cue: str) -> None:
        self.scores_of(cue, np.flatnonzero(self.available(cue)))

    def _decode(self) -> None:
        for observation in self._observations:
            with suppress(UnusableObservation):  # which the cues say
                _ = observation.image

    def _compute(self, cue: str, model: CueModel, fresh: Rows) -> None:
        asked = [self._observations[row] for row in fresh]
        extracted = self._extraction.extract(model.cue, asked, skip=self._skip)
        self._note(cue, fresh, extracted.failed)
        features, rows = extracted.features, fresh[extracted.rows]
        if features is None:
            return

        def score(some: Rows) -> Scores:
            at = self._observations[rows[some[0]]] if len(some) == 1 else None
            return model.scores(take(features, some), at)

        scored = attempt(score, len(rows), skip=self._skip)
        self._note(cue, rows, scored.failed)
        for some, scores in scored.answers:
            self._values[cue][rows[some]] = scores.values

    def _note(self, cue: str, rows: Rows, failed: Mapping[int, UnusableObservation]) -> None:
        self.failed |= {(cue, int(rows[number])): error for number, error in failed.items()}

    def available(self, cue: str) -> NDArray[np.bool_]:  # noqa: D102
        model = self._model(cue)
        there = np.array(
            [all(map(each.has, model.cue.requires)) for each in self._observations], dtype=bool
        )
        if cue in self._asked:
            scored = ~np.isnan(self._values[cue]).any(axis=1)
            there = np.where(self._asked[cue], scored, there)
        return there

    def used(self, row: int) -> tuple[str, ...]:  # noqa: D102
        asked = (cue for cue in self.cues if cue in self._values)
        return tuple(cue for cue in asked if not np.isnan(self._values[cue][row]).any())

    def scores_at(self, row: int) -> dict[str, Scores]:
        """Return the scores of one observation that are there so far, one row a cue."""
        at = [row]
        return {
            cue: Scores(self._values[cue][at], self._model(cue).layout).read_only()
            for cue in self.used(row)
        }

    def reason(self, row: int) -> UnusableObservation:
        """Return why one observation cannot be told."""
        found = (self.failed.get((cue, row)) for cue in self.cues)
        stamp = self._observations[row].stamp
        nothing = UnusableObservation(f"nothing can be told of the observation at stamp {stamp}")
        return next((error for error in found if error is not None), nothing)

    def why(self, cue: str, row: int) -> UnusableObservation:
        """Return why one observation has no scores of a cue."""
        if (cue, row) in self.failed:
            return self.failed[cue, row]
        try:
            self._observations[row].require(self._model(cue).cue.requires)
        except UnusableObservation as error:
            return error
        return self.reason(row)

    def take(self, rows: Some) -> Evidence:  # noqa: D102
        return _View(self, self.cues, _some(rows, len(self)))

    def only(self, cues: Sequence[str]) -> Evidence:  # noqa: D102
        return _View(self, cues, np.arange(len(self)))

    def _model(self, cue: str) -> CueModel:
        if cue not in self._models:
            raise UsageError(f"there is no cue '{cue}'; {choices(cue, self.cues)}")
        return self._models[cue]


class _View(Evidence):
    """Some of the cues and observations of evidence that is computed on demand."""

    def __init__(self, whole: ObservedEvidence, cues: Sequence[str], rows: Rows) -> None:
        self.cues = tuple(cues)
        self._whole, self._rows = whole, rows
        for cue in self.cues:
            whole.layout(cue)  # or there is no such cue

    def __len__(self) -> int:
        return len(self._rows)

    def layout(self, cue: str) -> Layout:
        return self._whole.layout(self._here(cue))

    def scores(self, cue: str) -> Scores:
        return self._whole.scores_of(self._here(cue), self._rows)

    def available(self, cue: str) -> NDArray[np.bool_]:
        return self._whole.available(self._here(cue))[self._rows]

    def used(self, row: int) -> tuple[str, ...]:
        used = self._whole.used(int(self._rows[row]))
        return tuple(cue for cue in used if cue in self.cues)

    def take(self, rows: Some) -> Evidence:
        return _View(self._whole, self.cues, self._rows[_some(rows, len(self))])

    def only(self, cues: Sequence[str]) -> Evidence:
        return _View(self._whole, [self._here(cue) for cue in cues], self._rows)

    def _here(self, cue: str) -> str:
        if cue not in self.cues:
            raise UsageError(f"there is no cue '{cue}'; {choices(cue, self.cues)}")
        return cue


def _some(rows: Some, n: int) -> Rows:
    """Return the numbers of some of n observations."""
    return np.arange(n)[np.asarray(rows)] if len(rows) else np.empty(0, dtype=np.int64)


def concatenate(parts: Sequence[Evidence]) -> StoredEvidence:
    """Return the evidence of several batches, such as those of several sequences, as one.

    Raises
    ------
    UsageError
        If there is none, or the parts are of other cues or layouts.
    """
    if not parts:
        raise UsageError("no evidence to concatenate: give one part or more")
    first = parts[0]
    joined = {}
    for part in parts[1:]:
        if part.cues != first.cues:
            raise UsageError(
                f"evidence of the cues {', '.join(first.cues)} cannot be joined to evidence of "
                f"{', '.join(part.cues)}: give parts of the same cues"
            )
    for cue in first.cues:
        layout = first.layout(cue)
        for part in parts[1:]:
            if part.layout(cue) != layout:
                raise UsageError(
                    f"the scores of cue '{cue}' are {layout} in one part and {part.layout(cue)} "
                    "in another: join parts by models of one layout and the same classes"
                )
        values = np.concatenate([part.scores(cue).values for part in parts])
        joined[cue] = Scores(values, layout)
    return StoredEvidence(joined, np.concatenate([part.trained_on() for part in parts]))
