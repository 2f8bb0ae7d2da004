"""The layout of votes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue import Layout

#: Shares are sums of weights: what differs by less than this is level.
_LEVEL = 1e-9


@dataclass(frozen=True)
class Votes(Layout):
    """Column j is the share of the votes for class j, column M + j its rank points.

    The most votes win; among the tied the most rank points (Borda's count: a voter's last choice
    has 0 points, its first 1, in equal steps); then the label that sorts first. The confidence is
    the lead of the winner over the runner-up in votes, 0 where they are tied.
    """

    name: ClassVar[str] = "votes"

    @property
    def columns(self) -> tuple[str, ...]:  # noqa: D102
        return tuple(f"{name}:{what}" for what in ("votes", "points") for name in self.classes)

    def preference(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how many other classes each class stands before, shape (n, M)."""
        votes, points = (
            each[:, :, None] - each[:, None, :] for each in np.split(values, 2, axis=1)
        )
        before = (votes > _LEVEL) | ((np.abs(votes) <= _LEVEL) & (points > _LEVEL))
        return np.asarray(before.sum(axis=2), dtype=np.float64)

    def confidence(  # noqa: D102
        self, values: NDArray[np.float64], ranking: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        first = np.take_along_axis(values, ranking[:, :2], axis=1)
        return np.asarray(first[:, 0] - first[:, 1])
