"""Work in C that is deaf to Ctrl-C, which the main thread can be called away from."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import copy_context
from types import FrameType
from typing import TypeVar

T = TypeVar("T")
#: Where a wait cannot be interrupted (Windows), Ctrl-C is heard this often, s.
_PATIENCE = 0.5


def interruptible(work: Callable[[], T]) -> T:
    """Do work that lets go of the interpreter, such as LIBSVM's, and hear Ctrl-C meanwhile.

    Called from the main thread, which alone is told of Ctrl-C, the work is done in another one
    (a tenth of a millisecond more), and ``KeyboardInterrupt`` leaves it behind. Nothing can stop
    such a thread: it ends with its work, or with the process, which does not wait for it.

    Parameters
    ----------
    work : callable
        Takes no arguments.

    Returns
    -------
    object
        What ``work`` returns; what it raises is raised.

    Raises
    ------
    KeyboardInterrupt
        At Ctrl-C, while the work goes on.
    """
    if threading.current_thread() is not threading.main_thread():
        return work()
    done = threading.Event()
    results: list[T] = []
    errors: list[BaseException] = []

    def do() -> None:
        try:
            results.append(work())
        except BaseException as error:
            errors.append(error)
        finally:
            done.set()

    # In the caller's context; a daemon, as the interpreter waits at its end for all others.
    threading.Thread(target=copy_context().run, args=(do,), daemon=True).start()
    while not done.wait(_PATIENCE):
        pass
    if errors:
        raise errors.pop()  # and hold no frame, whose arrays may be large
    return results[0]


@contextmanager
def stopped_by_interrupt(stop: Callable[[], None]) -> Iterator[None]:
    """Let the first Ctrl-C inside call ``stop``, after which the command goes on to its end.

    A second one ends the command as any does. Elsewhere than in the main thread, which alone is
    told of Ctrl-C, nothing changes.

    Parameters
    ----------
    stop : callable
        Lets what runs come to its end; it must not wait.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGINT)
    watched = signal.set_wakeup_fd(-1)  # who watches there ends the process

    def restore() -> None:
        signal.signal(signal.SIGINT, before)
        signal.set_wakeup_fd(watched, warn_on_full_buffer=False)

    def first(number: int, frame: FrameType | None) -> None:
        restore()
        stop()

    signal.signal(signal.SIGINT, first)
    try:
        yield
    finally:
        restore()
