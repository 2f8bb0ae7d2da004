"""A log whose observations say where they come from."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from placecue.observation import Observation, Origin
from placecue.source import Wrapped


class CachedLog(Wrapped):
    """A source, unchanged but for the origin of each observation."""

    def __iter__(self) -> Iterator[Observation]:
        digest = self.digest()
        for number, observation in enumerate(self.source):
            yield observation.coming_from(Origin(digest, number))

    def digest(self) -> str:  # noqa: D102
        return self._digest

    @cached_property
    def _digest(self) -> str:
        return self.source.digest()
