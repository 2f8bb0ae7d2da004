"""A batch asked as one, and sample by sample where it failed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from placecue.errors import ComponentError, ContractError, UnusableObservation
from placecue.folds import Rows

T = TypeVar("T")


@dataclass
class Attempts(Generic[T]):
    """What came of asking about n samples.

    Parameters
    ----------
    answers : list of (rows, answer)
        One for the whole batch, or one for each sample that gave an answer.
    failed : dict of int to UnusableObservation
        Why the others gave none, by row.
    """

    answers: list[tuple[Rows, T]] = field(default_factory=list)
    failed: dict[int, UnusableObservation] = field(default_factory=dict)

    @property
    def rows(self) -> Rows:
        """The rows with answers, in order."""
        found = [rows for rows, _ in self.answers]
        return np.concatenate(found) if found else np.empty(0, dtype=np.int64)


def attempt(ask: Callable[[Rows], T], n: int, *, skip: bool = False) -> Attempts[T]:
    """Ask about n samples at once, and one by one where that fails.

    Parameters
    ----------
    ask : callable
        Given rows, returns an answer for all of them.
    n : int
        Number of samples.
    skip : bool
        Whether a component's error at one sample counts as an unusable observation. What breaks
        a promise (rows, widths, types) never does.

    Raises
    ------
    ComponentError
        At the first sample where the component fails, unless ``skip``; or of the whole batch, if
        it fails at no sample alone.
    """
    every = np.arange(n)
    if n == 0:
        return Attempts()
    try:
        return Attempts([(every, ask(every))])
    except ContractError:
        raise
    except (UnusableObservation, ComponentError) as error:
        if n == 1:
            return Attempts(failed={0: _unusable(error, skip)})
        found = attempt_each(ask, n, skip=skip)
        if not found.failed:
            raise
        return found


def attempt_each(ask: Callable[[Rows], T], n: int, *, skip: bool = False) -> Attempts[T]:
    """Ask about n samples one by one, where nothing is gained by asking about all at once.

    See :func:`attempt`.
    """
    found: Attempts[T] = Attempts()
    every = np.arange(n)
    for row in range(n):
        try:
            found.answers.append((every[row : row + 1], ask(every[row : row + 1])))
        except ContractError:
            raise
        except (UnusableObservation, ComponentError) as error:
            found.failed[row] = _unusable(error, skip)
    return found


def _unusable(error: Exception, skip: bool) -> UnusableObservation:
    if isinstance(error, UnusableObservation):
        return error
    if not skip:
        raise error
    unusable = UnusableObservation(str(error))
    unusable.__cause__ = error
    return unusable
