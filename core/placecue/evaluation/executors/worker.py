"""What happens around a task where it runs."""

from __future__ import annotations

import os
import pickle
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from threadpoolctl import threadpool_limits

from placecue.errors import FOREIGN, PlacecueError, told

#: How often a worker looks whether the process that started it is still there, s.
PATIENCE = 1.0


class Elsewhere(Exception):
    """The traceback of what a task raised, as text: it may have been in another process."""

    def __str__(self) -> str:
        return f"\n{self.args[0]}"


@dataclass(frozen=True)
class Failure:
    """What a task raised, in words that every process can read.

    Parameters
    ----------
    kind : type
        A subclass of PlacecueError.
    reason : str
        One line.
    trace : str
        The traceback.
    """

    kind: type[PlacecueError]
    reason: str
    trace: str

    @classmethod
    def of(cls, error: BaseException) -> Failure:
        """Describe an error, one of ours by its own words."""
        from traceback import format_exception

        trace = "".join(format_exception(error))
        if isinstance(error, PlacecueError) and str(error):
            return cls(type(error), str(error), trace)
        return cls(PlacecueError, told(error), trace)

    def error(self) -> PlacecueError:
        """Return it as an error again, chained to the traceback."""
        error = self.kind(self.reason)
        error.__cause__ = Elsewhere(self.trace)
        return error


@dataclass(frozen=True)
class Work:
    """A function that answers whatever happens, on one thread of BLAS.

    Parameters
    ----------
    function : callable
        Takes a task.
    home : int
        The process that shares tasks out.
    """

    function: Callable[[Any], Any]
    home: int

    def __call__(self, number: int, task: Any) -> tuple[int, Any]:
        """Return the number of the task, and what came of it: a value or a :class:`Failure`."""
        _end_with(self.home)
        _one_thread()
        try:
            value = self.function(task)
            if os.getpid() != self.home:
                # An answer that cannot travel would break some backends, and keep dask waiting.
                pickle.dumps(value)
            return number, value
        except FOREIGN as error:
            return number, Failure.of(error)


def _one_thread() -> None:
    """Keep BLAS and OpenMP of this process to one thread, for good where it is a worker.

    The process that shares tasks out among its own threads does so around them all, and sets back
    what it found.
    """
    threadpool_limits(1)


_watching: set[int] = set()


def _end_with(parent: int) -> None:
    """End this process when its parent ends: killed, that tells nobody."""
    if os.getpid() in _watching or os.getppid() != parent:
        return
    _watching.add(os.getpid())
    threading.Thread(target=_watch, args=(parent,), daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(PATIENCE)
    os._exit(1)
