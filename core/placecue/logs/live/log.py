"""A robot as a source of observations, while it drives."""

# Annotations are types here and no texts, as in placecue.logs.options.

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from time import time_ns
from urllib.parse import urlsplit

from placecue.checks import check_number
from placecue.errors import DataError, UsageError
from placecue.limits import current_limits
from placecue.logs.joining.feed import Feed
from placecue.logs.joining.silence import Silence, usual
from placecue.logs.joining.synchronise import Match
from placecue.logs.live.beginning import Beginning
from placecue.logs.live.channels import Channels
from placecue.logs.live.client import Client
from placecue.logs.live.file import LiveFile
from placecue.logs.live.inbox import Arrived, Inbox
from placecue.logs.live.newest import Newest
from placecue.logs.live.rate import Rate
from placecue.logs.reader import McapLog
from placecue.observation import Observation, Part

#: Of so many images or scans it is known when they arrived.
LAST = 1000

log = logging.getLogger(__name__)


@dataclass(eq=False, repr=False)
class LiveLog(McapLog):
    """What a robot sends, over the WebSocket protocol of Foxglove, joined as a log's messages are.

    The messages of the first moments say which topics, frames and clocks there are; then only what
    is needed is asked for. Observations are given in order as they come, and where whoever takes
    them does not keep up, the newest alone. The server may vanish and come back. It ends when
    :meth:`stop` is called. There is one stream: an iteration goes on where the one before stood.

    Parameters
    ----------
    path : str
        The server, such as ``ws://127.0.0.1:8765``.
    image_topic, scan_topic, pose_topic, label_topic, labels, parts, tolerance, window, pose_gap, \
silence, base_frame, laser_frame, pose_frame, range_max, transform_horizon
        See :class:`LogOptions`.
    beginning : float
        How much is looked at before topics are chosen, s; longer where there is neither an image
        nor a scan.
    patience : float or None
        How long an observation may wait, s; None: for ever, and none is dropped.
    quiet : float
        Where nothing comes so long it is said, s.

    Attributes
    ----------
    arrived : float
        When the image or scan of the observation that was given last arrived, s of
        ``time.monotonic``.
    """

    beginning: float = 2.0
    patience: float | None = 0.5
    quiet: float = 5.0

    def __post_init__(self) -> None:
        parts = urlsplit(self.path)
        if parts.scheme not in ("ws", "wss") or not parts.hostname:
            raise UsageError(
                f"'{self.path}' is no address of a server: give one such as ws://127.0.0.1:8765"
            )
        if self.start is not None or self.end is not None:
            raise UsageError("source.start and source.end are for recorded logs: leave them out")
        check_number("source.beginning", self.beginning, least=0)
        check_number("source.quiet", self.quiet, above=0)
        if self.patience is not None:
            check_number("source.patience", self.patience, least=0)
        self.name = parts.netloc
        limits = current_limits()
        self.inbox = Inbox(limits.waiting)
        self.channels = Channels()
        self.client = Client(
            self.path, self.inbox, self.channels, self._wanted, limits.message, Rate(limits.rate)
        )
        self.waiting: Newest[Match] = Newest(self.patience)
        self._first = Beginning(self.channels.contents, self.beginning, limits.waiting)
        self._chosen: frozenset[int] | None = None  # by number; None while all is looked at
        self._arrivals: dict[int, float] = {}  # by log time, s
        self.arrived = 0.0

    @cached_property
    def file(self) -> LiveFile:
        """The first messages; waits for them.

        Raises
        ------
        DataError
            If it was stopped before there was anything to see.
        """
        self.client.start()
        for arrived in self._arriving():
            self._first.add(arrived)
            if self._first.enough:
                break
        if not self._first.shows_something:
            raise DataError(f"{self.path}: stopped before there was an image or a scan")
        return LiveFile(self.name, self.channels.contents, self._first.messages)

    @cached_property
    def camera_silence(self) -> Silence | None:
        """When the camera counts as silent: any may fall silent yet."""
        scans = self.choices.get("scan")
        if self.driver == "scan" or self.silence is None or scans is None or not scans.topics:
            return None
        return usual(self.file, self._driver, self.silence)

    def stop(self) -> None:
        """Let the observations end after those that have come."""
        self.client.stop()

    @property
    def dropped(self) -> dict[str, int]:
        """How many observations and messages were dropped, as nobody kept up with them."""
        return {"observations": self.waiting.dropped, "messages": self.inbox.dropped}

    # The observations.

    def __iter__(self) -> Iterator[Observation]:
        """Yield observations as they come; see :meth:`McapLog.__iter__`."""
        feed = self._begun
        yield from self._waiting(feed)
        for arrived in self._arriving():
            self._take(feed, arrived)
            yield from self._waiting(feed)
        for match in feed.finish():
            self.waiting.add(self.waiting.clock(), match)
        yield from self._waiting(feed)
        feed.faults.join(self.client.faults)
        feed.faults.report()

    @cached_property
    def _begun(self) -> Feed:
        """The feed, after the beginning; from here on only what it reads is asked for."""
        feed = self.feed()
        self._chosen = frozenset(feed.readers)
        self.client.ask_again()
        log.info(f"{self.path}: {self.taken()}")
        now = self.waiting.clock()
        self._take(feed, [(now, message) for message in self._first.messages])
        self._first.messages.clear()
        self.file.forget()
        return feed

    def _waiting(self, feed: Feed) -> Iterator[Observation]:
        while len(self.waiting):
            match = self.waiting.next()
            self.arrived = self._arrival(match)
            observation = feed.observation(match)
            if observation is not None:
                yield observation
            self._take(feed, self.inbox.take(0))

    def _take(self, feed: Feed, arrived: list[Arrived]) -> None:
        for at, message in arrived:
            if message.channel_id in self._makers:
                self._arrivals[message.log_time] = at
            for match in feed.push(message):
                self.waiting.add(at, match)

    @cached_property
    def _makers(self) -> frozenset[int]:
        """The channels of what observations are made of."""
        makers: tuple[Part, ...] = ("image", "scan") if self.camera_silence else (self.driver,)
        return frozenset(n for part in makers for topic in self._read(part) for n in topic.channels)

    def _arrival(self, match: Match) -> float:
        """Return when what makes an observation arrived, s."""
        while len(self._arrivals) > LAST:
            del self._arrivals[next(iter(self._arrivals))]
        return self._arrivals.pop(match.driver.log_time, self.waiting.clock())

    def _arriving(self) -> Iterator[list[Arrived]]:
        """Yield what comes until all is over, and say where nothing does."""
        told = False
        while True:
            found = self.inbox.take(self.quiet)
            if found:
                told = False
                yield found
            elif self.inbox.closed:
                return
            elif not told and self.client.connected:  # or the client says that it is not
                self._tell_quiet()
                told = True

    def _tell_quiet(self) -> None:
        topics = sorted({each.topic for each in list(self.channels.contents.channels.values())})
        has = f"it has {', '.join(topics)}" if topics else "it has no topics"
        log.warning(f"{self.path}: nothing came for {self.quiet:g} s; waiting ({has})")

    def _wanted(self, number: int) -> bool:
        if self._chosen is None:
            return self._first.role(number) is not None
        return number in self._chosen

    # What a recorded log knows.

    def digest(self) -> str:
        """Return what tells this run from others."""
        return self._digest

    def count(self) -> int | None:
        """Return None: nobody knows how many observations there will be."""
        return None

    @cached_property
    def _digest(self) -> str:
        return f"{self.path} {time_ns()}"
