"""How features come from observations: straight from the cues, or from where they were kept."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from typing import Any, TypeVar

import numpy as np

from placecue import contracts
from placecue.attempts import Attempts, attempt, attempt_each
from placecue.cue import Cue
from placecue.errors import ContractError, UnusableObservation
from placecue.features import FeatureBatch, Features, form, join, spoilt_rows, stack, take
from placecue.folds import Rows
from placecue.guard import call
from placecue.observation import Observation, Origin
from placecue.ownership import provenance

AnyCue = TypeVar("AnyCue", bound=Cue)
T = TypeVar("T")
#: Observations that are extracted together where nobody waits for them.
BATCH = 32


@dataclass(frozen=True)
class Extracted:
    """The features of n observations, as far as there are any.

    Parameters
    ----------
    rows : ndarray of int64, shape (k,)
        Which of the observations have features.
    features : batch of k samples, or None
        None where k is 0.
    failed : dict of int to UnusableObservation
        Why the others have none, by row.
    """

    rows: Rows
    features: FeatureBatch | None
    failed: dict[int, UnusableObservation] = field(default_factory=dict)

    @classmethod
    def of(cls, cue: Cue, attempts: Attempts[FeatureBatch]) -> Extracted:
        """Return the answers of a cue as one batch."""
        batches = [batch for _, batch in attempts.answers]
        return cls(attempts.rows, joined(cue, batches) if batches else None, attempts.failed)

    def finite(self, cue: Cue, observations: Sequence[Observation]) -> Extracted:
        """Return the same without what has NaN or infinite features: the cue is missing there."""
        spoilt = np.empty(0, int) if self.features is None else spoilt_rows(self.features)
        if not len(spoilt):
            return self
        failed = dict(self.failed)
        for row in self.rows[spoilt]:
            failed[int(row)] = UnusableObservation(
                f"{provenance(cue)}: NaN or infinite (inf) features at stamp "
                f"{observations[row].stamp}"
            )
        sound = np.setdiff1d(np.arange(len(self.rows)), spoilt)
        assert self.features is not None  # or nothing was spoilt
        return Extracted(
            self.rows[sound], take(self.features, sound) if len(sound) else None, failed
        )


class Extraction:
    """Asks the cues, every time. A feature cache is a subclass that asks them once.

    A batch is asked for as a batch: a network looks at 32 images far faster than 32 times at one.
    """

    def extract(
        self, cue: Cue, observations: Sequence[Observation], *, skip: bool = False
    ) -> Extracted:
        """Return the features of observations; those that are unusable are said, not raised.

        Parameters
        ----------
        cue : Cue
            Fitted, where it learns.
        observations : sequence of Observation
        skip : bool
            Whether an observation at which the cue fails counts as unusable.
        """
        usable, failed = ready(cue, observations)
        in_batches = type(cue).transform is not Cue.transform
        asking, trying = (_asked, attempt) if in_batches else (_asked_one, attempt_each)
        asked = Extracted.of(
            cue,
            trying(lambda rows: asking(cue, [usable[row] for row in rows]), len(usable), skip=skip),
        ).finite(cue, usable)
        there = np.array([row for row in range(len(observations)) if row not in failed], np.int64)
        failed |= {int(there[row]): error for row, error in asked.failed.items()}
        return Extracted(there[asked.rows], asked.features, failed)

    def gather(
        self, cue: Cue, observations: Iterable[Observation], *, skip: bool = False
    ) -> Extracted:
        """Return the features of any number of observations, as :meth:`extract` does of a batch.

        No more than a batch of them is held.
        """
        rows: list[Rows] = []
        batches: list[FeatureBatch] = []
        failed: dict[int, UnusableObservation] = {}
        first = 0
        for some in batched(observations, BATCH):
            extracted = self.extract(cue, some, skip=skip)
            rows.append(first + extracted.rows)
            failed |= {first + row: error for row, error in extracted.failed.items()}
            if extracted.features is not None:
                batches.append(extracted.features)
            first += len(some)
        every = np.concatenate(rows) if rows else np.empty(0, dtype=np.int64)
        return Extracted(every, joined(cue, batches) if batches else None, failed)

    def fit(
        self,
        cue: AnyCue,
        observations: Iterable[Observation],
        labels: Any,
        origins: Sequence[Origin | None],
    ) -> AnyCue:
        """Fit a cue that learns, and return it; see :meth:`Cue.fit`.

        Parameters
        ----------
        cue : Cue
            What to fit.
        observations : iterable of n observations
            What to fit it on.
        labels : ndarray of str, shape (n,)
            Their classes.
        origins : sequence of n origins
            Where they come from, known without reading them again.
        """
        call(cue, "fit", observations, labels)
        return cue


def batched(items: Iterable[T], size: int) -> Iterator[list[T]]:
    """Yield lists of up to ``size`` items."""
    iterator = iter(items)
    while some := list(islice(iterator, size)):
        yield some


def joined(cue: Cue, batches: Sequence[FeatureBatch]) -> FeatureBatch:
    """Return what a cue made of several observations or batches, one after the other.

    Raises
    ------
    ContractError
        If they are not of one kind and width.
    """
    first = batches[0]
    for batch in batches[1:]:
        if form(batch) != form(first):
            raise ContractError(
                f"{provenance(cue)}: made {form(batch)} after {form(first)}: the features of a "
                "cue must be alike"
            )
    return first if len(batches) == 1 else join(batches)


def ready(
    cue: Cue, observations: Sequence[Observation]
) -> tuple[list[Observation], dict[int, UnusableObservation]]:
    """Return the observations whose parts are there and decode, and why the others' are not."""
    usable, failed = [], {}
    for row, observation in enumerate(observations):
        try:
            observation.require(cue.requires)
            if "image" in cue.requires:
                _ = observation.image
            usable.append(observation)
        except UnusableObservation as error:
            failed[row] = error
    return usable, failed


def _asked_one(cue: Cue, observations: Sequence[Observation]) -> FeatureBatch:
    """Return what a cue makes of the only one of some observations, checked."""
    [observation] = observations
    check = contracts.features
    features: Features = call(cue, "extract", observation, check=check, at=observation)
    return stack([features])


def _asked(cue: Cue, observations: Sequence[Observation]) -> FeatureBatch:
    """Return what a cue makes of observations, checked."""
    at = observations[0] if len(observations) == 1 else None
    check = partial(contracts.batch, n=len(observations))
    batch: FeatureBatch = call(cue, "transform", observations, check=check, at=at)
    return batch
