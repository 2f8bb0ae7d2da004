"""An MCAP file: which topics it holds, and their messages."""

from __future__ import annotations

import hashlib
import logging
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

from mcap.records import ChunkIndex, McapRecord, Message

from placecue.errors import DataError
from placecue.limits import current_limits
from placecue.logs.mcap import indexed, linear
from placecue.logs.mcap.contents import Contents, read_contents
from placecue.logs.mcap.linear import MAGIC, Damage

__all__ = ["MAGIC", "Contents", "LogFile", "Topic"]

log = logging.getLogger(__name__)

#: Beginnings of files that people mistake for MCAP, and what to do with them.
OTHER_FILES = {
    b"#ROSBAG": "a ROS 1 bag, which source=rosbag reads",
    b"SQLite format 3": "a ROS 2 sqlite3 bag, which source=rosbag reads",
    b"\x1f\x8b": "gzip-compressed; unpack it first",
}


@dataclass(frozen=True, slots=True)
class Topic:
    """One topic of a log.

    Parameters
    ----------
    name : str
        Such as ``/scan``.
    schema : str
        Name of the schema, such as ``sensor_msgs/msg/LaserScan``; empty where there is none.
    encoding : str
        How messages are encoded, such as ``cdr`` or ``json``.
    channels : tuple of int
        Ids of its channels; several where several nodes published.
    count : int or None
        Number of messages; None where the file does not say.
    depth : bool
        Whether its images are depth images.
    """

    name: str
    schema: str
    encoding: str
    channels: tuple[int, ...]
    count: int | None
    depth: bool = False

    def __str__(self) -> str:
        count = "?" if self.count is None else str(self.count)
        return f"{self.name} ({self.schema or 'no schema'}, {count} messages)"


class LogFile:
    """An MCAP file on disk. It is opened anew for every pass, so passes may overlap.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    DataError
        If it is missing, empty or not MCAP, or cut off before its first message.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.size = _checked_size(self.path)
        self.contents: Contents = read_contents(self.path, self.size)
        self._told_of_chunks = False
        self._sound: set[int] = set()
        check_channels(self.path, len(self.contents.channels))
        if self.contents.damage is not None:
            self._tell_cut(self.contents.damage, (self.contents.counts or Counter()).total())
        elif self.contents.lost or self.contents.absent:
            self._tell_absent()

    def topics(self) -> list[Topic]:
        """Return the topics in order of name; one that changes its schema appears twice."""
        groups: dict[tuple[str, str, str], list[int]] = {}
        for number, channel in sorted(self.contents.channels.items()):
            schema = self.contents.schemas.get(channel.schema_id)
            key = (channel.topic, schema.name if schema else "", channel.message_encoding)
            groups.setdefault(key, []).append(number)
        counts = self.contents.counts
        return [
            Topic(*key, tuple(ids), None if counts is None else sum(counts[i] for i in ids))
            for key, ids in sorted(groups.items())
        ]

    def messages(
        self, channels: Collection[int], since: int | None = None, until: int | None = None
    ) -> Iterator[Message]:
        """Yield the messages of some channels.

        In order of log time where the file has an index, else in the order of the file.

        Parameters
        ----------
        channels : collection of int
            Ids of the wanted channels.
        since, until : int, optional
            First log time to give, and the one to stop before, ns.
        """
        since = 0 if since is None else since
        until = 2**64 if until is None else until
        wanted = frozenset(channels)
        damaged: list[Damage] = []
        with self.path.open("rb") as file:
            if self.contents.chunks:
                chunks = [
                    chunk
                    for chunk in self.contents.chunks
                    if chunk.message_end_time >= since
                    and chunk.message_start_time < until
                    and _may_hold(chunk, wanted)
                ]
                found: Iterator[McapRecord] = indexed.messages(
                    file, chunks, wanted, damaged.append, self._sound
                )
            else:
                # What is damaged was told when the file was opened.
                found = linear.records(file, self.size, lambda damage: None, wanted)
            for record in found:
                if (
                    isinstance(record, Message)
                    and record.channel_id in wanted
                    and since <= record.log_time < until
                ):
                    yield record
        self._tell_chunks(damaged)

    def digest(self) -> str:
        """Return the SHA-256 of the file's bytes, in hexadecimal."""
        with self.path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()

    def _tell_chunks(self, damaged: list[Damage]) -> None:
        if damaged and not self._told_of_chunks:
            self._told_of_chunks = True
            lost = [damage.lost for damage in damaged]
            known = None if None in lost else sum(each or 0 for each in lost)
            log.warning(
                f"{self.path}: {len(damaged)} of {len(self.contents.chunks)} chunks are damaged, "
                f"the first at byte {damaged[0].offset} ({damaged[0].reason}); {told_lost(known)}, "
                "and what is left of them may be wrong"
            )

    def _tell_absent(self) -> None:
        contents = self.contents
        chunks = f"{contents.absent} chunks" if contents.absent != 1 else "a chunk"
        what = f"{chunks} that its summary names" if contents.absent else "messages that it names"
        log.warning(
            f"{self.path}: {what} cannot be found, as if cut out; {told_lost(contents.lost)}, "
            "and the rest is read"
        )

    def _tell_cut(self, damage: Damage, messages: int) -> None:
        contents = self.contents
        seconds = (contents.end - contents.start) * 1e-9
        place = f"byte {damage.offset} of {self.size} ({damage.reason})"
        if not messages:
            raise DataError(
                f"{self.path} is cut off or damaged before its first message: nothing can be read "
                f"past {place}"
            ) from damage
        more = len(contents.damages) - 1
        log.warning(
            f"{self.path} is cut off or damaged: read {messages} messages over {seconds:.1f} s, "
            f"but not at {place}{f' and in {more} places behind it' if more else ''}; "
            f"{told_lost(contents.lost)}; 'mcap recover' makes a whole file of what is left"
        )


def check_channels(path: Path, count: int) -> None:
    """Refuse a log with more channels than logs may have.

    Raises
    ------
    DataError
        If it has too many.
    """
    over = current_limits().over("channels", count)
    if over:
        raise DataError(f"{path} has {count} channels, {over}")


def told_lost(count: int | None) -> str:
    """Say how many messages are lost; None is an unknown number."""
    if count is None:
        return "how many messages are lost is not known"
    return f"{count or 'no'} message{'s are' if count != 1 else ' is'} lost"


def _checked_size(path: Path) -> int:
    try:
        with path.open("rb") as file:
            start = file.read(16)
            size = path.stat().st_size
    except FileNotFoundError as error:
        raise DataError(f"no such log: {path}") from error
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}") from error
    if size == 0:
        raise DataError(f"{path} is empty (0 bytes): not an MCAP file")
    if not start.startswith(MAGIC):
        hint = next((hint for sign, hint in OTHER_FILES.items() if start.startswith(sign)), None)
        raise DataError(
            f"{path} is not an MCAP file ("
            + (f"it is {hint})" if hint else f"it begins with {start[:8]!r})")
        )
    return size


def _may_hold(chunk: ChunkIndex, channels: frozenset[int]) -> bool:
    offsets = chunk.message_index_offsets
    return not offsets or not channels.isdisjoint(offsets)
