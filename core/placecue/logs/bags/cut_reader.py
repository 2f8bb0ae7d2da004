"""A bag that is read front to back, as what would lead to its messages is missing."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Iterator
from typing import NamedTuple, Self

from rosbags.interfaces import Connection


class Held(NamedTuple):
    """A connection, or a message of one.

    Parameters
    ----------
    number : int
        Of the connection.
    stamp : int
        Time of the message, ns.
    data : bytes
        The message.
    connection : Connection or None
        None for a message.
    """

    number: int
    stamp: int
    data: bytes
    connection: Connection | None = None


class CutReader(ABC):
    """What can be read of a bag without its end; has the methods of a rosbags reader.

    All of it is looked through at first.

    Attributes
    ----------
    connections : list of rosbags Connection
        Who published what, with the number of messages that are left.
    start_time, end_time : int
        Time of the first message, and after that of the last, ns.
    message_count : int
        How many messages are left.
    """

    def __init__(self) -> None:
        self.start_time, self.end_time = 2**63 - 1, 0
        found: dict[int, Connection] = {}
        counts: Counter[int] = Counter()
        for held in self._held():
            if held.connection is not None:
                found.setdefault(held.number, held.connection)
            else:
                counts[held.number] += 1
                self.start_time = min(self.start_time, held.stamp)
                self.end_time = max(self.end_time, held.stamp + 1)
        self.connections = [each._replace(msgcount=counts[i]) for i, each in found.items()]
        self.message_count = counts.total()

    def messages(
        self, connections: Collection[Connection], start: int | None = None, stop: int | None = None
    ) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield connection, time (ns) and bytes of the messages of some connections.

        Parameters
        ----------
        connections : collection of rosbags Connection
            The wanted ones.
        start, stop : int, optional
            First time to give, and the one to stop before, ns.
        """
        wanted = {each.id: each for each in connections}
        for held in self._held():
            since = start is None or held.stamp >= start
            until = stop is None or held.stamp < stop
            if held.connection is None and held.number in wanted and since and until:
                yield wanted[held.number], held.stamp, held.data

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    @abstractmethod
    def _held(self) -> Iterator[Held]:
        """Yield connections, and messages behind theirs, in the order of the files."""
