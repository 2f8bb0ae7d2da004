"""A source: anything that observations come from."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import count
from types import MappingProxyType
from typing import Any, ClassVar, overload

from placecue import contracts
from placecue.camera import PinholeCamera
from placecue.guard import call, step
from placecue.observation import Observation, Origin, Recording


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
    metadata: Mapping[str, str] = MappingProxyType({})
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
        self.source = guarded(source)
        self.name = self.source.name

    @property
    def camera(self) -> PinholeCamera | None:  # type: ignore[override]
        """The camera of the images, where it is known."""
        return self.source.camera

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
        self.sources = tuple(map(guarded, sources))
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


class Guarded(Source):
    """A source as anybody may have written it: what it raises or gives wrongly is one line.

    Its observations say which log they are of, and where in it they stand.

    Parameters
    ----------
    source : Source
        Where observations come from.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.name = self._of("name", contracts.text)

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """Conditions of the recording."""
        return MappingProxyType(dict(self._of("metadata", contracts.metadata)))

    @property
    def camera(self) -> PinholeCamera | None:  # type: ignore[override]
        """The camera of the images, where it is known."""
        camera: PinholeCamera | None = self._of("camera", contracts.camera)
        return camera

    def __iter__(self) -> Iterator[Observation]:
        iterator = step(self.source, "iteration", iter, self.source)
        recording = Recording(self.name, self.digest)
        for number in count():
            at = f"at observation {number} of {self.name}"
            made = step(self.source, "iteration", next, iterator, _END, check=_observation, at=at)
            if made is _END:
                return
            yield made.of_log(self.name, Origin(recording, number))

    def digest(self) -> str:  # noqa: D102
        return self._digest

    def count(self) -> int | None:  # noqa: D102
        number: int | None = call(self.source, "count", check=contracts.count)
        return number

    @cached_property
    def _digest(self) -> str:
        return str(call(self.source, "digest", check=contracts.text))

    def _of(self, attribute: str, check: Any) -> Any:
        return step(self.source, attribute, getattr, self.source, attribute, check=check)


_END = object()


def _observation(made: Any) -> str | None:
    return None if made is _END else contracts.observation(made)


@overload
def guarded(observations: Source) -> Source: ...
@overload
def guarded(observations: Iterable[Observation]) -> Iterable[Observation]: ...
def guarded(observations: Iterable[Observation]) -> Iterable[Observation]:
    """Return a source behind the guard; other iterables, which are no components, as they are."""
    if isinstance(observations, Guarded) or not isinstance(observations, Source):
        return observations
    return Guarded(observations)


def innermost(source: Source) -> Source:
    """Return what was built, without what was put around it."""
    while isinstance(source, (Guarded, Wrapped)):
        source = source.source
    return source
