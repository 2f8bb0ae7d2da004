"""Every so-many-th observation of a recording."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

from placecue.checks import check_whole
from placecue.observation import Observation
from placecue.source import Source, Wrapped


class Thinned(Wrapped):
    """Every k-th observation of a source.

    Parameters
    ----------
    source : Source
    every : int
        k; 1 for all.
    """

    def __init__(self, source: Source, every: int) -> None:
        super().__init__(source)
        check_whole("every", every, least=1)
        self.every = every

    def __iter__(self) -> Iterator[Observation]:
        return (each for number, each in enumerate(self.source) if number % self.every == 0)

    def digest(self) -> str:
        """Return a digest of the content."""
        whole = self.source.digest()
        if self.every == 1:
            return whole
        return hashlib.sha256(f"{whole} every {self.every}".encode()).hexdigest()

    def count(self) -> int | None:
        """Return the number of observations where it is known beforehand."""
        count = self.source.count()
        return None if count is None else -(-count // self.every)
