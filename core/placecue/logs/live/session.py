"""One connection to a server: what it advertises, what is asked for, the messages that come."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from threading import Lock

from mcap.records import Message

from placecue.logs.live.channels import Channels
from placecue.logs.live.protocol import (
    Advertisement,
    BadFrame,
    Data,
    Status,
    Withdrawal,
    read,
    subscription,
    unsubscription,
)


class Session:
    """Follows what a server says in one connection; it knows nothing of sockets.

    Parameters
    ----------
    channels : Channels
        Gives channels their numbers.
    wanted : callable
        Tells of a number whether its messages are wanted.
    send : callable
        Sends a frame to the server.

    Attributes
    ----------
    said : list of Status
        What the server had to say and was not taken yet.
    """

    def __init__(
        self, channels: Channels, wanted: Callable[[int], bool], send: Callable[[str], None]
    ) -> None:
        self.channels = channels
        self.wanted = wanted
        self.send = send
        self.said: list[Status] = []
        self._subscriptions: dict[int, tuple[int, int]] = {}  # to the server's number and ours
        self._last = 0  # number that was given to a subscription
        self._lock = Lock()  # what is wanted changes from another thread

    def take(self, frame: str | bytes) -> Message | None:
        """Take in a frame, and return the message that it holds, if any.

        Raises
        ------
        BadFrame
            If it makes no sense.
        """
        event = read(frame)
        if isinstance(event, Data):
            return self._message(event)
        if isinstance(event, Advertisement):
            self._advertised(event)
        elif isinstance(event, Withdrawal):
            self._drop(lambda channel, _: channel in event.ids, tell=False)
        elif isinstance(event, Status):
            self.said.append(event)
        return None

    def ask_again(self) -> None:
        """Ask for no more messages of channels that are not wanted any longer."""
        self._drop(lambda _, number: not self.wanted(number), tell=True)

    def _message(self, event: Data) -> Message | None:
        found = self._subscriptions.get(event.subscription)
        if found is None and 0 < event.subscription <= self._last:
            return None  # it was under way when we asked for no more
        if found is None:
            raise BadFrame(f"a message for subscription {event.subscription}, which there is not")
        return Message(found[1], event.time, event.data, event.time, sequence=0)

    def _advertised(self, event: Advertisement) -> None:
        named = {channel.id for channel in event.channels}
        self._drop(lambda channel, _: channel in named, tell=True)
        asked = []
        with self._lock:
            for channel in event.channels:
                number = self.channels.number(channel)
                if number is not None and self.wanted(number):
                    self._last += 1
                    self._subscriptions[self._last] = channel.id, number
                    asked.append((self._last, channel.id))
        if asked:
            self.send(subscription(asked))

    def _drop(self, which: Callable[[int, int], bool], *, tell: bool) -> None:
        with self._lock:
            gone: Iterable[int] = [
                own for own, numbers in self._subscriptions.items() if which(*numbers)
            ]
            for own in gone:
                del self._subscriptions[own]
        if gone and tell:
            self.send(unsubscription(gone))
