"""A log whose observations say where they come from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

from placecue.observation import Observation, Origin
from placecue.source import Source


class CachedLog(Source):
    """A source, unchanged but for the origin of each observation.

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

    def __iter__(self) -> Iterator[Observation]:
        digest = self.digest()
        for number, observation in enumerate(self.source):
            yield observation.coming_from(Origin(digest, number))

    def digest(self) -> str:  # noqa: D102
        return self._digest

    @cached_property
    def _digest(self) -> str:
        return self.source.digest()

    def count(self) -> int | None:  # noqa: D102
        return self.source.count()
