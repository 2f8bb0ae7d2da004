"""Messages that wait to be read: so many bytes, and of what does not fit the oldest goes first."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable
from threading import Condition
from time import monotonic

from mcap.records import Message

#: Messages with when they came, s on a clock of their own.
Arrived = tuple[float, Message]


class Inbox:
    """Takes messages from one thread and hands them to another, in the order of their coming.

    Where they take more than ``most`` bytes the oldest of the channel that takes most is dropped:
    an image rather than a pose.

    Parameters
    ----------
    most : int
        Bytes that may wait.
    clock : callable
        Gives the time of arrival, s.

    Attributes
    ----------
    dropped : int
        How many messages were dropped.
    """

    def __init__(self, most: int, clock: Callable[[], float] = monotonic) -> None:
        self.most = most
        self.clock = clock
        self.dropped = 0
        self._waiting: deque[Arrived] = deque()
        self._bytes: Counter[int] = Counter()
        self._closed = False
        self._changed = Condition()

    def put(self, message: Message) -> None:
        """Take in a message."""
        with self._changed:
            self._waiting.append((self.clock(), message))
            self._bytes[message.channel_id] += len(message.data)
            while self._bytes.total() > self.most and len(self._waiting) > 1:
                self._drop(self._bytes.most_common(1)[0][0])
            self._changed.notify()

    def take(self, timeout: float | None = None) -> list[Arrived]:
        """Return all messages that wait, once there is one, or none after so many seconds."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._closed, timeout)
            found = list(self._waiting)
            self._waiting.clear()
            self._bytes.clear()
            return found

    def close(self) -> None:
        """Let :meth:`take` wait no longer; what has come can still be taken."""
        with self._changed:
            self._closed = True
            self._changed.notify()

    @property
    def closed(self) -> bool:
        """Whether nobody waits for messages any longer."""
        return self._closed

    def _drop(self, channel: int) -> None:
        at = next(i for i, (_, each) in enumerate(self._waiting) if each.channel_id == channel)
        self._bytes[channel] -= len(self._waiting[at][1].data)
        del self._waiting[at]
        self.dropped += 1
