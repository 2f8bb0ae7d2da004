"""What went wrong during one pass over a log: counted, and said once."""

from __future__ import annotations

import logging
from collections import Counter

log = logging.getLogger(__name__)


class Faults:
    """Counts faults by kind and keeps the first example of each.

    Parameters
    ----------
    where : str
        Name of the log, for messages.
    """

    def __init__(self, where: str) -> None:
        self.where = where
        self.counts: Counter[str] = Counter()
        self.first: dict[str, str] = {}

    def add(self, kind: str, example: str, count: int = 1) -> None:
        """Count a fault, such as ``messages could not be used``."""
        self.counts[kind] += count
        self.first.setdefault(kind, example)

    def report(self) -> None:
        """Warn of everything in one line; say nothing where all was well."""
        if self.counts:
            told = (
                f"{n} {kind} (the first: {self.first[kind]})" for kind, n in self.counts.items()
            )
            log.warning(f"{self.where}: {'; '.join(told)}")
