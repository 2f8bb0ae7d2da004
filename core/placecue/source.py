"""A source: anything that observations come from."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar

from placecue.camera import PinholeCamera
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
    camera : PinholeCamera or None
        The camera of the images, where it is known; logs are written with it.
    reads_many : bool
        Whether the parameter ``path`` may be a list; elsewhere each file is a source of its own.
    """

    reads_many: ClassVar[bool] = False
    name: str = "source"
    metadata: Mapping[str, str] = {}
    camera: PinholeCamera | None = None

    @abstractmethod
    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations in order of time."""

    @abstractmethod
    def digest(self) -> str:
        """Return a digest of the content, the same for the same observations."""

    def count(self) -> int | None:
        """Return the number of observations where it is known beforehand, for progress bars."""
        return None

    def __length_hint__(self) -> int:
        count = self.count()
        return NotImplemented if count is None else count


class Wrapped(Source):
    """A source in another, which changes its observations and nothing that is said of it.

    Parameters
    ----------
    source : Source
        Where observations come from.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.name = source.name
        self.camera = source.camera

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """Conditions of the recording."""
        return self.source.metadata

    def count(self) -> int | None:  # noqa: D102
        return self.source.count()


class Chain(Source):
    """Several sources, one after the other.

    Parameters
    ----------
    sources : sequence of Source
        In the order in which they are read.
    """

    def __init__(self, sources: Sequence[Source]) -> None:
        self.sources = tuple(sources)
        self.name = " + ".join(source.name for source in self.sources)

    def __iter__(self) -> Iterator[Observation]:
        for source in self.sources:
            yield from source

    def digest(self) -> str:  # noqa: D102
        joined = " ".join(source.digest() for source in self.sources)
        return hashlib.sha256(joined.encode()).hexdigest()

    def count(self) -> int | None:  # noqa: D102
        counts = [source.count() for source in self.sources]
        return sum(counts) if None not in counts else None  # type: ignore[arg-type]
