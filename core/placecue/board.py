"""How far an evaluation is: experiments, pairs done and failed, and an estimate of what is left."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from placecue.plain_progress import EVERY, Clock, Say, to_stderr

if TYPE_CHECKING:
    from rich.table import Table

#: So many must be finished before a time is foretold from them.
ENOUGH = 3


@dataclass
class Row:
    """An experiment.

    Parameters
    ----------
    total : int
        How many pairs it has.
    done, failed : int
        How many are finished, those that failed among them, and those of earlier runs.
    """

    total: int
    done: int = 0
    failed: int = 0
    #: Wall time that went by before each that finished in this run, since the one before it, s.
    spans: list[float] = field(default_factory=list)

    @property
    def remaining(self) -> int:
        """How many are to be done."""
        return max(0, self.total - self.done)


class Board:
    """Counts what is done. Time is foretold from what this run has finished, and from that only.

    A pair of an experiment is taken to last what its pairs have lasted so far; as long as there
    are not enough of those, what all have.

    Parameters
    ----------
    clock : callable
        Returns the time, s.

    Attributes
    ----------
    rows : dict of str to Row
        By experiment.
    """

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self._clock = clock
        self._began = self._last = clock()
        self._lock = threading.Lock()
        self.rows: dict[str, Row] = {}
        self._step = ""

    def step(self, name: str, done: int = 0, total: int = 0) -> None:
        """Say what comes before the pairs, such as recording logs, and how many are done.

        The empty name: nothing does any more.
        """
        with self._lock:
            self._step = name and (f"{name} {done} of {total}" if total else name)
            self._last = self._clock()

    def add(self, experiment: str, total: int, done: int = 0) -> None:
        """Put up an experiment; ``done`` of its pairs are there from an earlier run."""
        with self._lock:
            self.rows[experiment] = Row(total, done)

    def done(self, experiment: str, failed: bool = False) -> None:
        """Count a pair that is finished."""
        with self._lock:
            row, now = self.rows[experiment], self._clock()
            row.done += 1
            row.failed += failed
            row.spans.append(now - self._last)
            self._last = now

    @property
    def elapsed(self) -> float:
        """Since the board was put up, s."""
        return self._clock() - self._began

    def left(self, experiment: str | None = None) -> float | None:
        """Return how long an experiment, or all, will take from now, s.

        None as long as there is too little to go by. Between two that finish it goes down, but by
        no more than one takes on average.
        """
        with self._lock:
            spans = [span for row in self.rows.values() for span in row.spans]
            rows = self.rows.values() if experiment is None else [self.rows[experiment]]
            if not any(row.remaining for row in rows):
                return 0.0
            if len(spans if experiment is None else self.rows[experiment].spans) < ENOUGH:
                return None
            mean = sum(spans) / len(spans)
            seconds = sum(row.remaining * _span(row, mean) for row in rows)
            return max(seconds - min(self._clock() - self._last, mean), 0.0)

    def line(self) -> str:
        """Return where it stands, in one line."""
        left = self.left() if self.rows and not self._step else None
        rows = (
            [self._step]
            if self._step
            else [f"{name} {_count(row)}" for name, row in self.rows.items()]
        )
        foretold = "" if left is None else f", about {duration(left)} left"
        return f"{', '.join(rows) or 'preparing'} ({duration(self.elapsed)}{foretold})"

    def table(self) -> Table:
        """Return where it stands as a table for a terminal."""
        from rich.table import Table

        table = Table(box=None, pad_edge=False)
        for number, heading in enumerate(("experiment", "done", "of", "failed", "time left")):
            table.add_column(heading, justify="right" if number else "left")
        for name, row in self.rows.items():
            table.add_row(name, *_cells(row.done, row.total, row.failed, self.left(name)))
        if len(self.rows) > 1:
            rows = self.rows.values()
            done, total = sum(row.done for row in rows), sum(row.total for row in rows)
            failed = sum(row.failed for row in rows)
            table.add_row("all", *_cells(done, total, failed, self.left()))
        return table

    def __rich__(self) -> Table | str:
        return self.table() if self.rows and not self._step else self.line()


def _span(row: Row, otherwise: float) -> float:
    return sum(row.spans) / len(row.spans) if len(row.spans) >= ENOUGH else otherwise


def _count(row: Row) -> str:
    failed = f" ({row.failed} failed)" if row.failed else ""
    return f"{row.done} of {row.total}{failed}"


def _cells(done: int, total: int, failed: int, left: float | None) -> list[str]:
    told = "" if left is None else "done" if done >= total else duration(left)
    return [str(done), str(total), str(failed or ""), told]


def duration(seconds: float) -> str:
    """Return a time in words: ``42 s``, ``5 min``, ``2 h 10 min``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"


@contextmanager
def shown_board(board: Board) -> Iterator[Board]:
    """Show a board on standard error: live to people, a line every ten seconds through a pipe."""
    from rich.console import Console

    console = Console(stderr=True)
    if console.is_terminal:
        from rich.live import Live

        with Live(board, console=console, transient=True, refresh_per_second=2):
            yield board
        return
    with telling(board, to_stderr):
        yield board


@contextmanager
def telling(board: Board, say: Say, every: float = EVERY) -> Iterator[None]:
    """Say a board's line again and again, from a thread, while the block runs."""
    finished = threading.Event()

    def tell() -> None:
        while not finished.wait(every):
            say(board.line())

    thread = threading.Thread(target=tell, daemon=True)
    thread.start()
    try:
        yield
    finally:
        finished.set()
        thread.join()
