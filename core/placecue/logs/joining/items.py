"""Messages with their time and their part, decoded only when they are used."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mcap.records import Message

from placecue import contracts
from placecue.errors import ContractError, DataError, UnusableObservation
from placecue.guard import call
from placecue.logs import adapters
from placecue.logs.adapters import contract
from placecue.logs.adapters.base import Role
from placecue.logs.adapters.lookup import adapter_for
from placecue.logs.adapters.texts import check_writable
from placecue.logs.mcap.container import LogFile, Topic
from placecue.logs.messages.decoders import HEADER_STAMPS, decoder_for


class Item:
    """One message: its time, what it gives, and how to get at it.

    Parameters
    ----------
    stamp : int
        Time of measurement, ns.
    role : {"image", "scan", "pose", "label", "transform"}
        What :meth:`value` gives.
    read : callable
        Gives the value; called once at most, unless it fails.

    Attributes
    ----------
    spoilt : bool
        Whether it was counted that there is no value.
    """

    __slots__ = ("_read", "_value", "role", "spoilt", "stamp")

    def __init__(self, stamp: int, role: Role, read: Callable[[], Any]) -> None:
        self.stamp = stamp
        self.role = role
        self._read: Callable[[], Any] | None = read
        self._value: Any = None
        self.spoilt = False

    def value(self) -> Any:
        """Return the part of an observation that the message gives.

        Raises
        ------
        UnusableObservation
            If the message cannot be decoded or makes no sense.
        """
        if self._read is not None:
            self._value = self._read()
            self._read = None
        return self._value


class TopicReader:
    """Turns the messages of one topic into items.

    Parameters
    ----------
    file : LogFile
        The log.
    topic : Topic
        One that has an adapter.
    finish : callable, optional
        Applied to each value, such as the mounting of a laser.

    Raises
    ------
    DataError
        If its messages cannot be decoded.
    """

    def __init__(
        self, file: LogFile, topic: Topic, finish: Callable[[Any], Any] | None = None
    ) -> None:
        adapter = adapter_for(topic.encoding, topic.schema)
        if adapter is None:
            raise DataError(f"{topic.name}: {topic.encoding} {topic.schema} cannot be read")
        self.topic = topic
        self.adapter = adapter
        self.role: Role = adapter.role
        self.finish = finish
        self._check = contract.VALUES[adapter.role]
        contents = file.contents
        channels = {number: contents.channels[number] for number in topic.channels}
        self._decode = {
            number: decoder_for(channel, contents.schemas.get(channel.schema_id))
            for number, channel in channels.items()
        }
        self._peek = HEADER_STAMPS.get(topic.encoding) if adapter.header_first else None

    def item(self, message: Message) -> Item | None:
        """Return the item of a message; None where it holds nothing of interest.

        Raises
        ------
        UnusableObservation
            If not even its time can be read.
        """
        try:
            if self._peek is not None:
                stamp = self._peek(message.data)
                decoded = None
            else:
                decoded = self._decode[message.channel_id](message.data)
                stamp = call(self.adapter, "stamp", decoded, check=contracts.stamp)
                if not contracts.fits(stamp):
                    raise OverflowError(f"a stamp of {stamp} ns")
        except Exception as error:  # decoders raise anything over damaged bytes
            if self._breaks_promise(error):
                raise
            raise self._unusable(message.log_time, error) from error
        stamp = stamp if stamp > 0 else message.log_time
        return Item(stamp, self.role, lambda: self._value(message, stamp, decoded))

    def decoded(self, message: Message) -> Any:
        """Return a message with its fields.

        Raises
        ------
        UnusableObservation
            If it cannot be decoded.
        """
        try:
            return self._decode[message.channel_id](message.data)
        except Exception as error:  # decoders raise anything over damaged bytes
            raise self._unusable(message.log_time, error) from error

    def _value(self, message: Message, stamp: int, decoded: Any) -> Any:
        try:
            if decoded is None:
                decoded = self._decode[message.channel_id](message.data)
            origin = f"{self.topic.name} at stamp {stamp}"
            value = call(self.adapter, "value", decoded, origin, check=self._check)
            check_writable(value)
            return value if self.finish is None else self.finish(value)
        except UnusableObservation:
            raise
        except Exception as error:  # decoders raise anything over damaged bytes
            if self._breaks_promise(error):
                raise
            raise self._unusable(stamp, error) from error

    def _breaks_promise(self, error: Exception) -> bool:
        """Tell whether an adapter is to blame; of our own we know that it is the message."""
        ours = type(self.adapter).__module__.startswith(f"{adapters.__name__}.")
        return isinstance(error, ContractError) and not ours

    def _unusable(self, stamp: int, error: Exception) -> UnusableObservation:
        reason = " ".join(str(error).split()) or type(error).__name__
        return UnusableObservation(
            f"a message of {self.topic.name} at {stamp} does not decode as {self.topic.schema}: "
            f"{reason}"
        )
