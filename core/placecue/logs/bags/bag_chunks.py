"""A ROS 1 bag by the places of its chunks, each read from its front.

The index of a bag says where in a chunk each message is; it is not needed, and may mislead.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Collection, Generator
from itertools import count
from typing import Any, NamedTuple

from rosbags import rosbag1
from rosbags.interfaces import Connection
from rosbags.rosbag1.reader import ChunkInfo, ReaderError

from placecue.logs.bags.bag_cut import (
    CHUNK,
    CHUNK_INFO,
    CONNECTION,
    MAGIC_LINE,
    inside,
    records,
    unpacked,
)
from placecue.logs.bags.cut_reader import Held
from placecue.logs.mcap.linear import Damage, describe


class Due(NamedTuple):
    """A message in its turn.

    Parameters
    ----------
    stamp : int
        Its time, ns.
    number : int
        How many messages were read before it.
    held : Held
        The message.
    """

    stamp: int
    number: int
    held: Held


class ChunkReader(rosbag1.Reader):
    """Reads a bag chunk by chunk, in order of time; chunks that overlap are merged.

    Attributes
    ----------
    damages : list of Damage
        Chunks that could not be read to their end in the last pass.
    """

    def __init__(self, path: Any) -> None:
        super().__init__(path)
        self.damages: list[Damage] = []
        self._numbers = count()

    def open(self) -> None:
        """Open the bag and read its index.

        Raises
        ------
        ReaderError
            If it cannot be read, or the index is not all that the bag has.
        """
        super().open()
        try:
            self._check_index()
        except BaseException:
            self.close()
            raise

    def _check_index(self) -> None:
        known = {each.id for each in self.connections}
        counted = {number for info in self.chunk_infos for number in info.connection_counts}
        if not counted <= known:
            raise ReaderError("the index counts messages of connections that it does not describe")
        assert self.bio is not None  # it is open
        size = self.path.stat().st_size
        self.bio.seek(len(MAGIC_LINE))
        fields, _, _ = next(records(self.bio, size))
        self.bio.seek(int.from_bytes(fields[b"index_pos"], "little"))
        kinds = Counter(fields[b"op"] for fields, _, _ in records(self.bio, size))
        if kinds[CHUNK_INFO] != len(self.chunk_infos) or kinds[CONNECTION] != len(known):
            raise ReaderError("the bag says to have fewer chunks or connections than its index")

    def messages(
        self,
        connections: Collection[Connection] = (),
        start: int | None = None,
        stop: int | None = None,
    ) -> Generator[tuple[Connection, int, bytes], None, None]:
        """Yield connection, time (ns) and bytes of the messages of some connections."""
        wanted = {each.id: each for each in connections or self.connections}
        since, until = start or 0, 2**64 if stop is None else stop
        self.damages = []
        pending: list[Due] = []  # in order of time
        for info in sorted(self.chunk_infos, key=lambda each: each.start_time):
            if info.end_time <= since or info.start_time >= until:
                continue
            due = bisect_left(pending, (info.start_time,))
            yield from _given(pending[:due], wanted, since, until)
            del pending[:due]
            pending = sorted([*pending, *self._chunk(info, wanted)])
        yield from _given(pending, wanted, since, until)

    def _chunk(self, info: ChunkInfo, wanted: dict[int, Connection]) -> list[Due]:
        """Return the wanted messages of a chunk, as far as they can be read."""
        found: list[Due] = []
        reason = None
        try:
            assert self.bio is not None  # it is open
            size = self.path.stat().st_size
            self.bio.seek(info.pos)
            fields, data, whole = next(records(self.bio, size))
            if fields[b"op"] != CHUNK:
                raise ValueError("the index points to something that is not a chunk")
            content, reason = unpacked(fields, data)
            for held in inside(content, whole and reason is None):
                if held.connection is None and held.number in wanted:
                    found.append(Due(held.stamp, next(self._numbers), held))
        except Exception as error:  # a parser fed with damaged bytes may raise anything
            reason = describe(error)
        said = sum(number for each, number in info.connection_counts.items() if each in wanted)
        lost = max(said - len(found), 0)
        if lost or reason is not None:
            reason = reason or "it holds fewer messages than the index says"
            self.damages.append(Damage(info.pos, reason, lost))
        return found


def _given(
    due: list[Due], wanted: dict[int, Connection], since: int, until: int
) -> Generator[tuple[Connection, int, bytes], None, None]:
    for stamp, _, held in due:
        if since <= stamp < until:
            yield wanted[held.number], stamp, held.data
