"""A source under other labels: those of the rooms it was recorded in, or mapped ones."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Iterator, Mapping
from typing import Any

from placecue.errors import UsageError
from placecue.labels.label_map import LabelMap
from placecue.labels.rooms import Rooms, read_rooms
from placecue.observation import Observation
from placecue.source import Source, Wrapped

log = logging.getLogger(__name__)


class Relabelled(Wrapped):
    """A source whose observations get other labels. All else stays as it is, undecoded.

    Parameters
    ----------
    source : Source
        Where observations come from.
    rooms : Rooms, optional
        They take the place of the source's own labels: an observation gets the class of the room
        that its pose lies in, none where it lies in no room or has no pose.
    label_map : LabelMap, optional
        Applied to the label, be it the source's own or that of a room.
    """

    def __init__(
        self, source: Source, rooms: Rooms | None = None, label_map: LabelMap | None = None
    ) -> None:
        super().__init__(source)
        self.rooms = rooms
        self.label_map = label_map
        self._told = False

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations, relabelled.

        Raises
        ------
        UsageError
            If a label is not in the map and that is an error.
        """
        hits = Hits(self)
        for observation in self.source:
            yield observation.relabelled(hits.label(observation))
        hits.tell()

    def label(self, observation: Observation) -> str | None:
        """Return the new label of an observation, or None."""
        label, pose = observation.label, observation.pose
        if self.rooms is not None:
            label = None if pose is None else self.rooms.at(pose.x, pose.y)
        return label if self.label_map is None else self.label_map(label)

    def digest(self) -> str:
        """Return a digest of the source and of what relabels it."""
        rooms = self.rooms and [
            (room.label, [ring.tolist() for ring in room.rings]) for room in self.rooms.rooms
        ]
        names = self.label_map and (sorted(self.label_map.names.items()), self.label_map.unmapped)
        return hashlib.sha256(f"{self.source.digest()} {rooms} {names}".encode()).hexdigest()

    def tell_outside(self, total: int, frames: set[str]) -> None:
        """Warn that no observation lies in a room; once."""
        if not self._told:
            self._told = True
            where = f"given in {' and '.join(sorted(frames))}" if frames else "missing"
            log.warning(
                f"{self.name}: not one of {total} observations lies in a room; the poses are "
                f"{where}: are the rooms drawn in the same frame, in metres?"
            )


class Hits:
    """Which observations of one pass over a source lie in a room.

    Parameters
    ----------
    source : Relabelled
        The source.
    """

    def __init__(self, source: Relabelled) -> None:
        self._source = source
        self._total = self._inside = 0
        self._frames: set[str] = set()

    def label(self, observation: Observation) -> str | None:
        """Return the new label of an observation, or None, and count it."""
        label = self._source.label(observation)
        self._total += 1
        self._inside += label is not None
        if observation.pose is not None:
            self._frames.add(observation.pose.frame)
        return label

    def tell(self) -> None:
        """Warn where the pass is over and no observation lay in a room."""
        if self._source.rooms is not None and self._total and not self._inside:
            self._source.tell_outside(self._total, self._frames)


def relabelled(source: Source, config: Mapping[str, Any]) -> Source:
    """Return a source under the labels that a config asks for.

    Parameters
    ----------
    source : Source
        Any source.
    config : mapping
        ``rooms``: a GeoJSON file whose polygons give the labels; ``label_map``: a mapping from
        old labels to new ones, or null; ``unmapped_labels``: keep, drop or error.

    Raises
    ------
    UsageError
        If the map makes no sense.
    DataError
        If the rooms cannot be read.
    """
    rooms, names = config.get("rooms"), config.get("label_map")
    if not rooms and not names:
        return source
    if names is not None and not isinstance(names, Mapping):
        raise UsageError(
            f"label_map must map old labels to new ones, such as {{BO:office,PA:null}}, got "
            f"{names!r}"
        )
    return Relabelled(
        source,
        read_rooms(str(rooms)) if rooms else None,
        LabelMap(names, config.get("unmapped_labels", "keep")) if names else None,
    )
