"""Progress of loops that may take long. Silent until somebody asks to see it.

Algorithms call :func:`track`; the command line opens :func:`shown` around them. Nothing else
knows of bars.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from operator import length_hint
from typing import Any, TypeVar

from placecue.plain_progress import PlainLines

T = TypeVar("T")
Reporter = Callable[[Iterable[Any], str, int | None], Iterable[Any]]

_reporter: ContextVar[Reporter | None] = ContextVar("placecue_progress", default=None)


def track(items: Iterable[T], what: str, total: int | None = None) -> Iterable[T]:
    """Return ``items``, reporting on them while they are consumed.

    Parameters
    ----------
    items : iterable
        What the loop runs over.
    what : str
        What the loop does, in a few words.
    total : int, optional
        Number of items, where ``len(items)`` does not tell.
    """
    reporter = _reporter.get()
    return items if reporter is None else reporter(items, what, total)


@contextmanager
def shown() -> Iterator[None]:
    """Show a bar on standard error for every :func:`track` inside; a pipe gets lines instead."""
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        with _reported_by(PlainLines()):
            yield
        return

    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
    )

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bars:

        def report(items: Iterable[T], what: str, total: int | None) -> Iterator[T]:
            length = total if total is not None else length_hint(items, -1)
            task = bars.add_task(what, total=length if length >= 0 else None)
            try:
                for item in items:
                    yield item
                    bars.advance(task)
            finally:
                bars.remove_task(task)

        with _reported_by(report):
            yield


@contextmanager
def _reported_by(reporter: Reporter) -> Iterator[None]:
    token = _reporter.set(reporter)
    try:
        yield
    finally:
        _reporter.reset(token)
