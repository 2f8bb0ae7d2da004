"""A source under labels that are known by time."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator

from placecue.observation import Observation
from placecue.source import Source, Wrapped


class LabelledAtTimes(Wrapped):
    """A source whose observations get the label of their time, or none.

    Parameters
    ----------
    source : Source
        Where observations come from.
    label_at : callable
        Returns the label at a stamp, ns, or None.
    said : str
        The labels in words, for the digest.
    """

    def __init__(self, source: Source, label_at: Callable[[int], str | None], said: str) -> None:
        super().__init__(source)
        self.label_at = label_at
        self.said = said

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations under their new labels."""
        for observation in self.source:
            yield observation.relabelled(self.label_at(observation.stamp))

    def digest(self) -> str:
        """Return a digest of the source and of its labels."""
        return hashlib.sha256(f"{self.source.digest()} {self.said}".encode()).hexdigest()
