"""A source: anything that observations come from."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping

from placecue.observation import Observation


class Source(ABC):
    """A log, a data set or a simulator: iterating it gives observations in order of time.

    It can be iterated again and again, and holds no more than one observation at a time.

    Attributes
    ----------
    name : str
        What to call it in messages, usually the file name.
    metadata : mapping of str to str
        Conditions of the recording (illumination, run, laboratory), as far as known.
    """

    name: str = "source"
    metadata: Mapping[str, str] = {}

    @abstractmethod
    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations in order of time."""

    @abstractmethod
    def digest(self) -> str:
        """Return a digest of the content, the same for the same observations."""

    def count(self) -> int | None:
        """Return the number of observations where it is known beforehand, for progress bars."""
        return None
