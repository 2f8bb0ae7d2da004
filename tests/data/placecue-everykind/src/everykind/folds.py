"""A fold scheme."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue import FoldScheme, check_whole


class OddEven(FoldScheme):
    """Runs of samples, dealt to the folds in turn."""

    def __init__(self, n_folds: int = 2, run: int = 3) -> None:
        super().__init__(n_folds)
        self.run = run

    def check_parameters(self) -> None:
        """Raise UsageError unless a run has a sample or more."""
        super().check_parameters()
        check_whole("folds.run", self.run, least=1)

    def assign(
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> NDArray[np.int64]:
        """Return the fold of each sample, shape (n,)."""
        return np.arange(len(np.asarray(labels))) // self.run % self.n_folds
