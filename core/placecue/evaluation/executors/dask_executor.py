"""Shares tasks out to a dask cluster.

Not through joblib, whose own backend waits for ever for a task whose worker died.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from placecue.evaluation.executors.executor import (
    Executor,
    Feed,
    Outcome,
    Task,
    Value,
    lost,
    outcome_of,
)
from placecue.evaluation.executors.worker import Failure, Work

#: How long the answer of a finished task may travel, s, and how often that is tried.
PATIENCE, TRIES = 20, 5
#: Dask computes the answer anew.
AGAIN = object()


class DaskExecutor(Executor):
    """Runs a function on tasks, as many at a time as the cluster has threads.

    A worker that dies takes with it the task that it ran, which fails, and answers that were not
    fetched yet, which dask computes anew. Nothing is sent that no thread is free for: dask would
    take what waits at a worker for what killed it.

    Parameters
    ----------
    client : distributed.Client
        Of the cluster.
    """

    def __init__(self, client: Any) -> None:
        super().__init__("dask", sum(client.ncores().values()), {})
        self._client = client

    def map(
        self, function: Callable[[Task], Value], tasks: Iterable[Task]
    ) -> Iterator[Outcome[Task, Value]]:
        """Yield what comes of each task as it finishes; see :meth:`Executor.map`."""
        from distributed import as_completed

        work, feed = Work(function, os.getpid()), Feed(tasks)
        taken = iter(feed)
        ended: Any = as_completed([], loop=self._client.loop, raise_errors=False)  # type: ignore[no-untyped-call]
        open_: dict[Any, tuple[Task, int]] = {}
        try:
            yield from self._fill(work, taken, ended, open_)
            while open_:
                future = next(ended)
                task, tries = open_.pop(future)
                answer = self._answer(future, tries)
                if answer is AGAIN:
                    open_[future] = task, tries - 1
                    ended.add(future)
                    continue
                yield outcome_of(task, answer)
                yield from self._fill(work, taken, ended, open_)
        finally:
            self._client.cancel(list(open_))
        if feed.error is not None:
            raise feed.error

    def _fill(
        self,
        work: Work,
        taken: Iterator[tuple[int, Task]],
        ended: Any,
        open_: dict[Any, tuple[Task, int]],
    ) -> Iterator[Outcome[Task, Any]]:
        """Send tasks while threads lack some; yield what comes of those that cannot be sent."""
        while len(open_) < max(1, self.jobs):
            try:
                number, task = next(taken)
            except StopIteration:
                return
            try:
                future = self._client.submit(work, number, task, pure=False)
            except Exception as error:
                yield outcome_of(task, Failure.of(error))
                continue
            open_[future] = task, TRIES
            ended.add(future)

    def _answer(self, future: Any, tries: int) -> Any:
        """Return what a task returned, or why there is nothing, or that it is to be waited for."""
        if future.status in ("lost", "pending") and tries:
            return AGAIN
        if future.status not in ("finished", "error"):
            return Failure.of(RuntimeError(f"dask lost its answer ({future.status})"))
        try:
            _, value = future.result(timeout=PATIENCE)
        except Exception as error:
            if isinstance(error, TimeoutError) and tries:
                return AGAIN
            return lost(self.name, error)
        return value
