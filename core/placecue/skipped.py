"""Observations that were passed over: counted, and said once."""

from __future__ import annotations

import logging

from placecue.errors import DataError, UnusableObservation

log = logging.getLogger(__name__)


class Skipped:
    """Counts unusable observations and keeps the first reason for a message.

    Attributes
    ----------
    count : int
        How many were passed over.
    first : UnusableObservation or None
        Why the first of them was.
    """

    def __init__(self) -> None:
        self.first: UnusableObservation | None = None
        self.count = 0

    def add(self, error: UnusableObservation) -> None:
        """Count one observation."""
        self.first = self.first or error
        self.count += 1

    def report(self, total: int) -> None:
        """Warn once if any were passed over.

        Raises
        ------
        DataError
            If not one of ``total`` observations was usable.
        """
        if self.first is None:
            return
        text = f"{self.count} of {total} observations passed over; the first: {self.first}"
        if self.count == total:
            raise DataError(f"no usable observation: {text}") from self.first
        log.warning(text)
