"""Progress for those who read a pipe or a log file: a line every ten seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from operator import length_hint
from typing import TypeVar

T = TypeVar("T")
Clock = Callable[[], float]
Say = Callable[[str], None]

#: Between two lines, s. What ends sooner is not told of.
EVERY = 10.0


@dataclass
class _Loop:
    what: str
    total: int
    began: float
    done: int = 0

    def __str__(self) -> str:
        return f"{self.what} {self.done}" + (f" of {self.total}" if self.total >= 0 else "")


class PlainLines:
    """Reports loops, the outer ones first; a reporter for ``placecue.progress``.

    Parameters
    ----------
    say : callable
        Takes a line.
    clock : callable
        Returns the time, s.
    """

    def __init__(self, say: Say | None = None, clock: Clock = time.monotonic) -> None:
        self._say = say or to_stderr
        self._clock = clock
        self._loops: list[_Loop] = []
        self._said = float("-inf")

    def __call__(self, items: Iterable[T], what: str, total: int | None) -> Iterator[T]:
        """Yield the items."""
        length = total if total is not None else length_hint(items, -1)
        loop = _Loop(what, length, self._clock())
        self._loops.append(loop)
        try:
            for item in items:
                yield item
                loop.done += 1
                self._tell()
        finally:
            self._loops.remove(loop)

    def _tell(self) -> None:
        now = self._clock()
        long = [loop for loop in self._loops if now - loop.began >= EVERY]
        if long and now - self._said >= EVERY:
            self._said = now
            self._say(f"{', '.join(map(str, long))} ({now - long[0].began:.0f} s)")


def to_stderr(line: str) -> None:
    """Write a line of progress."""
    print(f"progress: {line}", file=sys.stderr, flush=True)
