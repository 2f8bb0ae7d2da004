"""A layout."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue import Layout


@dataclass(frozen=True)
class Unlikeness(Layout):
    """Column j says how unlike class j a sample is, on some scale; the smallest wins."""

    scale: float = 1.0
    name: ClassVar[str] = "unlikeness"

    @property
    def columns(self) -> tuple[str, ...]:
        """One column a class."""
        return self.classes

    def preference(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how much each class is preferred, shape (n, M)."""
        return np.asarray(-values / self.scale)
