"""The clock of one topic: which messages came late, and where the clock itself jumped back."""

from __future__ import annotations

from dataclasses import dataclass

from placecue.logs.joining.items import Item


@dataclass(frozen=True, slots=True)
class Tick:
    """What an item says of its clock.

    Parameters
    ----------
    items : tuple of Item
        To be taken in now, in this order.
    late : Item or None
        One to be left out.
    since : int or None
        Where the clock goes on after a jump, ns; None where it did not jump.
    wild : bool
        Whether the jump only corrects one wild stamp.
    """

    items: tuple[Item, ...] = ()
    late: Item | None = None
    since: int | None = None
    wild: bool = False


class Clock:
    """Follows the stamps of one topic.

    A stamp that lies more than ``window`` before the newest one is kept until the next message
    tells what it was: where that one is back in time, the message was late; else the clock jumped
    back, or the newest stamp was wild.

    Parameters
    ----------
    window : int
        How late messages may come, ns.

    Attributes
    ----------
    newest : int or None
        The newest stamp, ns.
    """

    def __init__(self, window: int) -> None:
        self.window = window
        self.newest: int | None = None
        self._before: int | None = None  # the newest one before that
        self._doubtful: Item | None = None

    def tick(self, item: Item) -> Tick:
        """Take in the next item of the topic."""
        doubtful, self._doubtful = self._doubtful, None
        if self.newest is None or item.stamp >= self.newest - self.window:
            self._advance(item.stamp)
            return Tick((item,), late=doubtful)
        if doubtful is None:
            self._doubtful = item
            return Tick()
        wild = self._before is not None and doubtful.stamp >= self._before - self.window
        self._before, self.newest = (self._before if wild else None), doubtful.stamp
        rest = self.tick(item)
        return Tick((doubtful, *rest.items), since=doubtful.stamp, wild=wild)

    def finish(self) -> Item | None:
        """Return the item that nothing came after to explain, or None."""
        doubtful, self._doubtful = self._doubtful, None
        return doubtful

    def _advance(self, stamp: int) -> None:
        if self.newest is None or stamp > self.newest:
            self._before, self.newest = self.newest, stamp
