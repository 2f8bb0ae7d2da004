"""Ctrl-C ends a command within two seconds, whatever its threads are doing.

Python hands an interrupt to the main thread alone, once that is back from C code, and then waits
at its end for every other thread. Here a thread hears of it at once, and lets the command a moment
to clean up.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import Event, Thread, current_thread, main_thread
from typing import NoReturn

from placecue.atomic import abandon

#: How long a command may clean up before it is ended, s.
GRACE = 1.5
#: What shells expect of a command that was interrupted.
STATUS = 130


@contextmanager
def ending_in_time() -> Iterator[None]:
    """End the process if it is still in the ``with`` block a moment after an interrupt."""
    if current_thread() is not main_thread():  # which alone may listen for signals
        yield
        return
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    finished = Event()
    before = signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    Thread(target=_watch, args=(reading, finished), daemon=True).start()
    try:
        yield
    finally:
        finished.set()
        signal.set_wakeup_fd(before)
        os.close(writing)  # the thread reads to the end, and ends


def end(status: int) -> NoReturn:
    """End this process now, and those that it has started, waiting for no thread."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # nobody reads, or it is closed
            stream.flush()
    abandon()
    if "multiprocessing" in sys.modules:
        for child in sys.modules["multiprocessing"].active_children():
            child.kill()
    os._exit(status)


def _watch(reading: int, finished: Event) -> None:
    with open(reading, "rb", buffering=0) as signals:
        while told := signals.read(64):
            # SIGTERM is told of where somebody listens to it, as an executor does.
            if {signal.SIGINT, signal.SIGTERM}.intersection(told) and not finished.wait(GRACE):
                print("placecue: interrupted", file=sys.stderr)
                end(STATUS)
