"""Outputs of classifiers, and layouts that say what the columns are and how to decide on them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from functools import lru_cache, partial
from itertools import combinations
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, UsageError, described
from placecue.guard import call
from placecue.read_only import read_only

Values = NDArray[np.float64]

#: What sets one class before the next where a decision has no confidence in it.
SMALLEST_STEP = 1e-6


@dataclass(frozen=True, slots=True)
class Decision:
    """What a layout's rule makes of n rows of scores.

    Parameters
    ----------
    labels : ndarray of str, shape (n,)
        The winning class.
    confidence : ndarray of float64, shape (n,)
        How unambiguous the decision is; larger is surer. The unit is that of the scores.
    ranking : ndarray of int64, shape (n, M)
        Indices of the classes, best first.
    """

    labels: NDArray[np.str_]
    confidence: NDArray[np.float64]
    ranking: NDArray[np.int64]


@dataclass(frozen=True)
class Layout(ABC):
    """What the columns of scores are.

    Parameters
    ----------
    classes : tuple of str
        The M classes, sorted.
    """

    classes: tuple[str, ...]
    name: ClassVar[str]

    def __post_init__(self) -> None:
        for name, value in self.get_params().items():
            if isinstance(value, list):  # as configs and model folders have them
                object.__setattr__(self, name, tuple(value))
        if len(self.classes) < 2:
            raise UsageError(
                f"a layout needs two classes or more, got {list(self.classes)}: "
                "give data with samples of at least two places"
            )

    @property
    @abstractmethod
    def columns(self) -> tuple[str, ...]:
        """The names of the V columns."""

    @abstractmethod
    def preference(self, values: Values) -> Values:
        """Return how much each class is preferred: (n, V) scores to (n, M), larger is better."""

    def confidence(self, values: Values, ranking: NDArray[np.int64]) -> Values:
        """Return the lead of the winner over the runner-up in :meth:`preference`, shape (n,)."""
        ordered = np.take_along_axis(self.preference(values), ranking[:, :2], axis=1)
        return np.asarray(ordered[:, 0] - ordered[:, 1])

    def of_preference(self, preference: Values) -> Values | None:
        """Return scores of this layout that rank the classes like this, None where it cannot.

        The opposite of :meth:`preference`: (n, M) to (n, V), so that a belief of another layout
        can be told in this one.
        """
        return None

    def rank(self, values: Values) -> NDArray[np.int64]:
        """Return the classes from best to worst, shape (n, M); equal ones in order of label."""
        return np.argsort(-self.preference(values), axis=1, kind="stable").astype(np.int64)

    def decide(self, values: Values) -> Decision:
        """Apply the layout's own multi-class rule.

        Parameters
        ----------
        values : ndarray of float64, shape (n, V)
            Scores.

        Returns
        -------
        Decision

        Raises
        ------
        DataError
            If the number of columns is not V or a value is NaN.
        """
        values = np.asarray(values, dtype=np.float64)
        if values.ndim != 2 or values.shape[1] != len(self.columns):
            raise DataError(
                f"scores of shape {values.shape} do not fit the layout {self.name} of "
                f"{len(self.classes)} classes, which has {len(self.columns)} columns"
            )
        if np.isnan(values).any():
            raise DataError(f"{int(np.isnan(values).any(axis=1).sum())} rows of scores hold NaN")
        ranking = self.rank(values)
        labels = np.asarray(self.classes, dtype=np.str_)[ranking[:, 0]]
        return Decision(labels, self.confidence(values, ranking), ranking)

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Return the fields by name, as of every component."""
        return {each.name: getattr(self, each.name) for each in fields(self)}


@dataclass(frozen=True)
class _ColumnPerClass(Layout):
    """One column a class; the largest wins."""

    @property
    def columns(self) -> tuple[str, ...]:
        return self.classes

    def preference(self, values: Values) -> Values:
        return values

    def of_preference(self, preference: Values) -> Values | None:
        return preference


@dataclass(frozen=True)
class OneAgainstAll(_ColumnPerClass):
    """Column j is the discriminant function of class j against the rest; the largest wins."""

    name: ClassVar[str] = "one_against_all"


@dataclass(frozen=True)
class Probabilities(_ColumnPerClass):
    """Column j is the probability of class j; the largest wins."""

    name: ClassVar[str] = "probabilities"

    def of_preference(self, preference: Values) -> Values:
        """Return the softmax."""
        powers = np.exp(preference - preference.max(axis=1, keepdims=True))
        return np.asarray(powers / powers.sum(axis=1, keepdims=True))


@dataclass(frozen=True)
class ModifiedOneAgainstAll(_ColumnPerClass):
    """Columns are D_j - mean_j, one-against-all outputs centred; the one nearest to 0 wins.

    The mean of D_j is over the training samples of class j, and is taken off by whoever gives the
    scores, so that scores of machines with means of their own can stand side by side. The
    confidence is the distance of the runner-up from 0 less the winner's.

    References
    ----------
    Pronobis and Caputo, Confidence-based cue integration for visual place recognition, IROS 2007.
    """

    name: ClassVar[str] = "modified_one_against_all"

    def preference(self, values: Values) -> Values:  # noqa: D102
        return np.asarray(-np.abs(values))

    def of_preference(self, preference: Values) -> Values:  # noqa: D102
        return np.asarray(preference.max(axis=1, keepdims=True) - preference)


@dataclass(frozen=True)
class DecisionList(_ColumnPerClass):
    """Column j is the output of class j against the rest; the list's first positive one wins.

    The last class of the list is what is left, whatever its own output. After the winner come the
    other positive classes in order of the list, then the last class, then the others from the
    largest output down. The confidence is that of the surest-to-flip answer on the way down the
    list: the winner's output (unless it is the last) or the least negative before it.

    Parameters
    ----------
    order : tuple of str
        The classes in order of the list.

    References
    ----------
    Martinez Mozos, Stachniss and Burgard, ICRA 2005; the confidence is our choice.
    """

    order: tuple[str, ...] = ()
    name: ClassVar[str] = "decision_list"

    def __post_init__(self) -> None:
        super().__post_init__()
        if sorted(self.order) != sorted(self.classes):
            raise UsageError(
                f"a decision list names each of its classes {list(self.classes)} once, "
                f"got {list(self.order)}"
            )

    @property
    def places(self) -> NDArray[np.int64]:
        """The column of each class of the list, in order, shape (M,)."""
        return np.array([self.classes.index(name) for name in self.order])

    def preference(self, values: Values) -> Values:
        """Return ranks: those that accept in order of the list, the last class, then the rest."""
        places, m = self.places, len(self.classes)
        accepts = values > 0
        accepts[:, places[-1]] = True
        of_list = np.empty(m)
        of_list[places] = np.arange(m, 0, -1)
        order = np.lexsort((values, np.where(accepts, of_list, 0)), axis=1)
        return _ranks(order)

    def of_preference(self, preference: Values) -> Values:
        """Return outputs of which the winner's alone is positive."""
        best = np.sort(preference, axis=1)[:, -2:]
        return np.asarray(preference - best.mean(axis=1, keepdims=True))

    def confidence(self, values: Values, ranking: NDArray[np.int64]) -> Values:  # noqa: D102
        places = self.places
        asked = values[:, places[:-1]]
        at = np.argsort(places)[ranking[:, 0]][:, None]
        number = np.arange(len(places) - 1)[None, :]
        margins = np.where(number == at, asked, np.where(number < at, -asked, np.inf))
        return np.asarray(margins.min(axis=1))


@dataclass(frozen=True)
class OneAgainstOne(Layout):
    """Columns are the pairs (i, j), i < j, in order of label; positive means that i beats j.

    Majority vote; then a vote among the tied; then the class whose worst lost margin is least
    bad. The confidence is the smallest signed distance from the sample to the hyperplanes that
    separate the winner from each other class.
    """

    name: ClassVar[str] = "one_against_one"

    @property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """The class indices of each column."""
        return tuple(combinations(range(len(self.classes)), 2))

    @property
    def columns(self) -> tuple[str, ...]:  # noqa: D102
        return _pair_columns(self.classes)

    def of_preference(self, preference: Values) -> Values:
        """Return by how much the first class of each pair is preferred to the second."""
        first, second = _pair_indices(len(self.classes))
        return np.asarray(preference[:, first] - preference[:, second])

    def margins(self, values: Values) -> Values:
        """Return margin[s, i, j], by how much class i beats class j, shape (n, M, M)."""
        m = len(self.classes)
        table = np.zeros((len(values), m, m))
        first, second = _pair_indices(m)
        table[:, first, second] = values
        table[:, second, first] = -values
        return table

    def preference(self, values: Values) -> Values:
        """Return ranks by votes, then votes among the tied, then the worst margin."""
        return _ranks(self._order(values))

    def rank(self, values: Values) -> NDArray[np.int64]:  # noqa: D102
        return self._order(values)[:, ::-1]

    def _order(self, values: Values) -> NDArray[np.int64]:
        """Return the classes from worst to best, shape (n, M)."""
        margins = self.margins(values)
        wins = margins > 0
        votes = wins.sum(axis=2)
        level = votes[:, :, None] == votes[:, None, :]
        second = (wins & level).sum(axis=2)
        other = level & (second[:, :, None] == second[:, None, :])
        m = len(self.classes)
        other[:, range(m), range(m)] = False
        worst = np.where(other, margins, np.inf).min(axis=2)
        return np.lexsort((worst, second, votes), axis=1)

    def confidence(self, values: Values, ranking: NDArray[np.int64]) -> Values:  # noqa: D102
        rows, winners = np.arange(len(values)), ranking[:, 0]
        won = self.margins(values)[rows, winners]
        won[rows, winners] = np.inf
        return np.asarray(won.min(axis=1))


def _ranks(order: NDArray[np.int64]) -> Values:
    """Return the place of each class in an order from worst to best, shape (n, M)."""
    ranks = np.empty(order.shape)
    # np.put_along_axis takes as long as all else that is done for one sample.
    ranks[np.arange(len(order))[:, None], order] = np.arange(order.shape[1])
    return ranks


# Asked for at every observation, where they would take as long as the sums.
@lru_cache(maxsize=256)
def _pair_columns(classes: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{one}|{other}" for one, other in combinations(classes, 2))


@lru_cache(maxsize=256)
def _pair_indices(m: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    first, second = np.triu_indices(m, k=1)
    return read_only(first), read_only(second)


def promised(made: Any, n: int, classes: int) -> str | None:
    """Check what ``Layout.decide`` makes of n rows."""
    if not isinstance(made, Decision):
        return f"returned {described(made)}, not a Decision"
    for name, shape in (("labels", (n,)), ("confidence", (n,)), ("ranking", (n, classes))):
        values = getattr(made, name)
        if not isinstance(values, np.ndarray) or values.shape != shape:
            return f"returned a Decision whose {name} are no array of shape {shape}"
    return None


@dataclass(frozen=True, slots=True)
class Scores:
    """Real-valued outputs for n samples.

    Parameters
    ----------
    values : ndarray of float64, shape (n, V)
        The outputs.
    layout : Layout
        What the V columns are.
    """

    values: Values
    layout: Layout

    def decide(self) -> Decision:
        """Apply the layout's own rule; see :meth:`Layout.decide`."""
        check = partial(promised, n=len(self.values), classes=len(self.layout.classes))
        decision: Decision = call(self.layout, "decide", self.values, check=check)
        return decision

    def told_in(self, layout: Layout) -> Scores | None:
        """Return scores of another layout that say the same, None where they cannot be told in it.

        Labels stay, and the ranking except in a decision list; so does the confidence where the
        other layout's is a lead over the runner-up in the same unit.

        Parameters
        ----------
        layout : Layout
            Of the same classes.
        """
        if layout == self.layout:
            return self
        if layout.classes != self.layout.classes:
            return None
        there = np.flatnonzero(self.available())
        preference = self[there].preferences()
        values = layout.of_preference(preference)
        return None if values is None else Scores(values, layout).spread(there, len(self))

    def preferences(self) -> Values:
        """Return how much each class is preferred, in the unit of the confidence, shape (n, M).

        A layout that only ranks has no unit: there each class stands a step of the confidence
        behind the one before. The most preferred class is the one that the rule picks.
        """
        if type(self.layout).confidence is Layout.confidence:
            return self.layout.preference(self.values)
        decision = self.decide()
        step = np.maximum(decision.confidence, SMALLEST_STEP)
        preference = np.empty(decision.ranking.shape)
        places = -np.arange(decision.ranking.shape[1])[None, :] * step[:, None]
        np.put_along_axis(preference, decision.ranking, places, axis=1)
        return preference

    def available(self) -> NDArray[np.bool_]:
        """Return which samples have scores, shape (n,); a missing one is a row of NaN."""
        return np.asarray(~np.isnan(self.values).any(axis=1))

    def spread(self, rows: NDArray[np.integer], n: int) -> Scores:
        """Return scores of n samples: these at the given rows, NaN at the others."""
        values = np.full((n, self.values.shape[1]), np.nan)
        values[rows] = self.values
        return Scores(values, self.layout)

    def read_only(self) -> Scores:
        """Return the same scores such that nothing can write into them."""
        return Scores(read_only(self.values), self.layout)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, rows: Any) -> Scores:
        return Scores(self.values[rows], self.layout)
