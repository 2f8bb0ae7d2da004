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
from placecue.logs.messages.direct import direct_decoder

#: Clocks are one if they differ by less than this, ns: messages are recorded late, too.
APART = 1_000_000_000


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
    log_time : int, optional
        When it was recorded, ns; its time of measurement by default.
    stamped : bool
        Whether the message itself said its time of measurement.

    Attributes
    ----------
    spoilt : bool
        Whether it was counted that there is no value.
    """

    __slots__ = ("_read", "_value", "log_time", "role", "spoilt", "stamp", "stamped")

    def __init__(
        self,
        stamp: int,
        role: Role,
        read: Callable[[], Any],
        log_time: int | None = None,
        stamped: bool = True,
    ) -> None:
        self.stamp = stamp
        self.log_time = stamp if log_time is None else log_time
        self.stamped = stamped
        self.role = role
        self._read: Callable[[], Any] | None = read
        self._value: Any = None
        self.spoilt = False

    @property
    def known(self) -> bool:
        """Whether the value has been read, and is one."""
        return self._read is None

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
        Applied to each value and its time, such as the mounting of a laser.

    Attributes
    ----------
    shift : int
        What brings the stamps of the topic to the clock of the drivers, ns.
    behind : int
        How far the clock of the drivers is behind the recorder's, ns.
    unstamped : int
        How many messages so far had no stamp.
    lasts : bool
        Whether what a message says holds until the next one.

    Raises
    ------
    DataError
        If its messages cannot be decoded.
    """

    def __init__(
        self, file: LogFile, topic: Topic, finish: Callable[[Any, int], Any] | None = None
    ) -> None:
        adapter = adapter_for(topic.encoding, topic.schema)
        if adapter is None:
            raise DataError(f"{topic.name}: {topic.encoding} {topic.schema} cannot be read")
        self.topic = topic
        self.adapter = adapter
        self.role: Role = adapter.role
        self.lasts = adapter.role == "label"
        self.finish = finish
        self.shift = 0
        self.behind = 0
        self.unstamped = 0
        self._check = contract.VALUES[adapter.role]
        contents = file.contents
        channels = {number: contents.channels[number] for number in topic.channels}
        self._decode = {
            number: decoder_for(channel, contents.schemas.get(channel.schema_id))
            for number, channel in channels.items()
        }
        standard = all(
            direct_decoder(channel.message_encoding, contents.schemas.get(channel.schema_id))
            for channel in channels.values()
        )
        # Of a definition of one's own the header may stand elsewhere.
        peeks = adapter.header_first and standard
        self._peek = HEADER_STAMPS.get(topic.encoding) if peeks else None

    def item(self, message: Message) -> Item | None:
        """Return the item of a message; None where it holds nothing of interest.

        Raises
        ------
        UnusableObservation
            If not even its time can be read.
        """
        if self._peek is None:
            said, decoded = self.stamp(message)
        else:
            try:
                said, decoded = self._peek(message.data), None
            except Exception as error:  # damaged bytes
                raise self._unusable(message.log_time, error) from error
        log_time = message.log_time
        stamped = said > 0
        stamp = said + self.shift if stamped else self._guessed(log_time)
        return Item(
            stamp,
            self.role,
            lambda: self._value(message, stamp, decoded),
            log_time,
            stamped,
        )

    def _guessed(self, log_time: int) -> int:
        """Return the time of a message without a stamp; that of a label is the recorder's."""
        if self.role == "label":
            return log_time
        stamp = self.timed(0, log_time)
        self.unstamped += stamp != 0
        return stamp

    def stamp(self, message: Message) -> tuple[int, Any]:
        """Return what a message says of its time, ns, and the message decoded if that took it.

        Raises
        ------
        UnusableObservation
            If not even its time can be read.
        """
        try:
            if self._peek is not None:
                return self._peek(message.data), None
            decoded = self._decode[message.channel_id](message.data)
            stamp: int = call(self.adapter, "stamp", decoded, check=contracts.stamp)
            if not contracts.fits(stamp):
                raise OverflowError(f"a stamp of {stamp} ns")
            return stamp, decoded
        except Exception as error:  # decoders raise anything over damaged bytes
            if self._breaks_promise(error):
                raise
            raise self._unusable(message.log_time, error) from error

    def timed(self, stamp: int, log_time: int) -> int:
        """Return a stamp on the clock of the drivers; where there is none, from the log time.

        A stamp of 0 is one where that clock began when the message was recorded.
        """
        if stamp > 0:
            return stamp + self.shift
        guess = log_time - self.behind
        return 0 if self.behind and abs(guess) < APART else guess

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
            if self.role != "image":
                check_writable(value)
            return value if self.finish is None else self.finish(value, stamp)
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
