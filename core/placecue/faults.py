"""What went wrong during one pass over a log or a data set: counted, and said once."""

from __future__ import annotations

import logging
from collections import Counter

from placecue.errors import DataError

log = logging.getLogger(__name__)

#: The kind of fault of an observation that nothing can be made of.
PASSED_OVER = "observations passed over"


class Faults:
    """Counts faults by kind and keeps the first example of each.

    Parameters
    ----------
    where : str
        Name of the log or data set, for messages; empty where the examples say it.

    Attributes
    ----------
    counts : Counter of str
        How often each kind was met.
    first : dict of str to str
        The first example of each kind, in one line.
    cause : Exception or None
        The first example that was an error.
    """

    def __init__(self, where: str = "") -> None:
        self.where = where
        self.counts: Counter[str] = Counter()
        self.first: dict[str, str] = {}
        self.cause: Exception | None = None

    def add(self, kind: str, example: str | Exception, count: int = 1) -> None:
        """Count a fault, such as ``images are missing``, with an example of it."""
        if not count:
            return
        self.counts[kind] += count
        if isinstance(example, Exception):
            self.cause = self.cause or example
        # Names of files may hold bytes that no terminal can show, and errors line breaks.
        shown = str(example).encode("utf-8", "backslashreplace").decode()
        self.first.setdefault(kind, " ".join(shown.split()))

    def join(self, other: Faults) -> None:
        """Count what another counted."""
        for kind, count in other.counts.items():
            self.add(kind, other.first[kind], count)

    def pass_over(self, error: Exception) -> None:
        """Count an observation that nothing can be made of, and why."""
        self.add(PASSED_OVER, error)

    @property
    def passed_over(self) -> int:
        """How many observations were passed over."""
        return self.counts[PASSED_OVER]

    def told(self) -> str:
        """Return everything in one line; empty where all was well."""
        return "; ".join(
            f"{n} {kind} (the first: {self.first[kind]})" for kind, n in self.counts.items()
        )

    def report(self) -> None:
        """Warn of everything in one line; say nothing where all was well."""
        if self.counts:
            log.warning(self._at(self.told()))

    def report_of(self, total: int) -> None:
        """Warn in one line of the observations that were passed over, if any.

        Parameters
        ----------
        total : int
            How many observations there were.

        Raises
        ------
        DataError
            If not one of them was usable.
        """
        if not self.passed_over:
            return
        first = self.first[PASSED_OVER]
        text = f"{self.passed_over} of {total} {PASSED_OVER}; the first: {first}"
        if self.passed_over == total:
            raise DataError(self._at(f"no usable observation: {text}")) from self.cause
        log.warning(self._at(text))

    def _at(self, text: str) -> str:
        return f"{self.where}: {text}" if self.where else text


class MissingCues:
    """Counts at how many observations each cue was missing where others were there.

    Attributes
    ----------
    counts : Counter of str
        How often, by cue.
    first : dict of str to Exception
        Why, the first time.
    """

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.first: dict[str, Exception] = {}

    def add(self, cue: str, why: Exception) -> None:
        """Count a cue that an observation goes without."""
        self.counts[cue] += 1
        self.first.setdefault(cue, why)

    def report(self, total: int) -> None:
        """Warn of each cue that was missing, in one line; ``total`` observations there were."""
        for cue, count in self.counts.items():
            log.warning(
                f"cue {cue} is missing at {count} of {total} observations, which go on without "
                f"it; the first: {' '.join(str(self.first[cue]).split())}"
            )
