"""Keeps in touch with a server from a thread of its own, and goes back to it when it was away."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import suppress
from threading import Event, Thread

from placecue.errors import DataError, UsageError
from placecue.faults import Faults
from placecue.logs.live.channels import Channels
from placecue.logs.live.inbox import Inbox
from placecue.logs.live.protocol import SUBPROTOCOLS, BadFrame
from placecue.logs.live.rate import Rate
from placecue.logs.live.session import Session

#: How long it is waited before a server is tried again, s: longer from time to time.
FIRST_PAUSE, LONGEST_PAUSE = 0.2, 5.0
#: How soon it is heard that there is to be an end, s.
HEARING = 0.2
#: Status messages of this level or above are passed on to the user.
WARNING = 1

log = logging.getLogger(__name__)


class Client:
    """Listens to a server until it is told to stop.

    Parameters
    ----------
    url : str
        Such as ``ws://127.0.0.1:8765``.
    inbox : Inbox
        Takes the messages.
    channels : Channels
        Gives channels their numbers.
    wanted : callable
        Tells of a number whether its messages are wanted; may change, see :meth:`ask_again`.
    largest : int
        Bytes that a frame may have; a server that sends more is left, and tried again.
    rate : Rate
        How many messages a second are let through.

    Attributes
    ----------
    faults : Faults
        What went wrong so far.
    received : int
        Messages so far.
    connections : int
        How often the server was reached.

    Raises
    ------
    UsageError
        If ``websockets`` is not installed.
    """

    def __init__(
        self,
        url: str,
        inbox: Inbox,
        channels: Channels,
        wanted: Callable[[int], bool],
        largest: int,
        rate: Rate,
    ) -> None:
        try:
            import websockets.sync.client  # noqa: F401
        except ImportError as error:
            raise UsageError(
                "following a robot needs placecue[live]: pip install 'placecue[live]'"
            ) from error
        self.url = url
        self.inbox = inbox
        self.channels = channels
        self.wanted = wanted
        self.largest = largest
        self.rate = rate
        self.faults = Faults(url)
        self.received = 0
        self.connections = 0
        self._session: Session | None = None
        self._stopped = Event()
        self._thread = Thread(target=self._run, name="placecue live client", daemon=True)
        self._told = ""

    @property
    def connected(self) -> bool:
        """Whether there is a connection now."""
        return self._session is not None

    def start(self) -> None:
        """Begin to listen."""
        self._thread.start()

    def stop(self) -> None:
        """Hang up, and open the way for who waits for messages."""
        self._stopped.set()
        self.inbox.close()

    def ask_again(self) -> None:
        """Ask for no more messages of channels that are not wanted any longer."""
        session = self._session
        if session is not None:
            self._sending(session.ask_again)

    def _run(self) -> None:
        pause = FIRST_PAUSE
        while not self._stopped.is_set():
            before = self.connections
            try:
                self._listen()
            except Exception as error:  # sockets, handshakes and servers fail in many ways
                self._lost(" ".join(str(error).split()) or type(error).__name__)
            finally:
                self._session = None
            pause = FIRST_PAUSE if self.connections > before else min(2 * pause, LONGEST_PAUSE)
            self._stopped.wait(pause)

    def _listen(self) -> None:
        from websockets.sync.client import connect

        # No compression: small frames that unpack to large ones are not to be had.
        with connect(
            self.url,
            subprotocols=SUBPROTOCOLS,  # type: ignore[arg-type]
            compression=None,
            proxy=None,
            max_size=self.largest,
            close_timeout=1.0,
        ) as connection:
            if connection.subprotocol is None:
                raise DataError(f"it speaks neither {' nor '.join(SUBPROTOCOLS)}")
            session = self._session = Session(self.channels, self.wanted, connection.send)
            self.connections += 1
            log.info(f"{self.url}: {'connected' if self.connections == 1 else 'is back'}")
            self._told = ""
            while not self._stopped.is_set():
                with suppress(TimeoutError):
                    self._take(session, connection.recv(HEARING))

    def _take(self, session: Session, frame: str | bytes) -> None:
        if not self.rate.allows():
            kind = f"frames came above limits.rate={self.rate.most} a second and were left out"
            self.faults.add(kind, f"after {self.received} messages")
            return
        try:
            message = session.take(frame)
        except BadFrame as error:
            self.faults.add("frames made no sense", str(error))
            return
        for said in session.said:
            if said.level >= WARNING:
                self.faults.add("warnings came from the server", said.message[:200])
        session.said.clear()
        if message is not None:
            self.received += 1
            self.inbox.put(message)

    def _sending(self, send: Callable[[], None]) -> None:
        try:
            send()
        except Exception as error:  # the connection is gone, which its own thread says
            log.debug(f"{self.url}: {error}")

    def _lost(self, why: str) -> None:
        """Say that there is no connection, once as long as it is for the same reason."""
        if self._stopped.is_set() or why == self._told:
            return
        self._told = why
        what = "is gone" if self.connections else "cannot be reached"
        log.warning(f"{self.url} {what} ({why}); trying again until it is there")
