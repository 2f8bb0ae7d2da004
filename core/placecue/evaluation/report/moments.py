"""Moments to be labelled, with what was seen and what a model makes of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.report.pictured import Pictured


@dataclass(frozen=True)
class Moment(Pictured):
    """A moment of a log.

    Parameters
    ----------
    number : int
        Its line of the table, from 1.
    log : str
        Where it is from.
    stamp : int
        When, ns.
    suggested : str
        What the model takes it for.
    confidence : float
        How sure it is.
    image : bytes
        A small JPEG; empty where there is none.
    scan : ndarray of float64, shape (k, 2), or None
        Where the laser hit, in the robot's frame, m.
    """

    number: int
    log: str
    stamp: int
    suggested: str
    confidence: float
    image: bytes = b""
    scan: NDArray[np.float64] | None = None

    @property
    def seconds(self) -> str:
        """The stamp, s."""
        return f"{self.stamp // 10**9}.{self.stamp % 10**9:09d}"


@dataclass(frozen=True)
class Moments:
    """Some of them, on a page.

    Parameters
    ----------
    shown : sequence of Moment
        In the order of the table.
    """

    template: ClassVar[str] = "moments.html.j2"

    shown: Sequence[Moment]
