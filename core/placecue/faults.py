"""What went wrong during one pass over a log or a data set: counted, and said once."""

from __future__ import annotations

import logging
from collections import Counter

log = logging.getLogger(__name__)


class Faults:
    """Counts faults by kind and keeps the first example of each.

    Parameters
    ----------
    where : str
        Name of the log or data set, for messages.
    """

    def __init__(self, where: str) -> None:
        self.where = where
        self.counts: Counter[str] = Counter()
        self.first: dict[str, str] = {}

    def add(self, kind: str, example: str, count: int = 1) -> None:
        """Count a fault, such as ``images are missing``, with an example of it."""
        if count:
            self.counts[kind] += count
            # Names of files may hold bytes that no terminal can show, and errors line breaks.
            shown = example.encode("utf-8", "backslashreplace").decode()
            self.first.setdefault(kind, " ".join(shown.split()))

    def told(self) -> str:
        """Return everything in one line; empty where all was well."""
        return "; ".join(
            f"{n} {kind} (the first: {self.first[kind]})" for kind, n in self.counts.items()
        )

    def report(self) -> None:
        """Warn of everything in one line; say nothing where all was well."""
        if self.counts:
            log.warning(f"{self.where}: {self.told()}")
