"""Shares tasks out, and takes what comes of them as they finish."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import joblib

from placecue.errors import PlacecueError, told
from placecue.evaluation.executors.worker import Failure, Work

Task = TypeVar("Task")
Value = TypeVar("Value")


@dataclass(frozen=True)
class Outcome(Generic[Task, Value]):
    """What came of a task.

    Parameters
    ----------
    task : object
        The task.
    value : object
        What the function returned; None where it failed.
    error : PlacecueError or None
        Why there is no value, in one line.
    """

    task: Task
    value: Value | None = None
    error: PlacecueError | None = None


class Executor:
    """Runs a function on tasks, several at a time, by a backend of joblib.

    Parameters
    ----------
    name : str
        What the user calls it.
    jobs : int
        How many tasks run at a time.
    backend : mapping
        For ``joblib.parallel_config``.
    generates : bool
        Whether the backend hands out results as they come.
    """

    def __init__(
        self,
        name: str,
        jobs: int,
        backend: Mapping[str, Any],
        generates: bool = True,
    ) -> None:
        self.name = name
        self.jobs = jobs
        self._backend = dict(backend)
        self._generates = generates

    def map(
        self, function: Callable[[Task], Value], tasks: Iterable[Task]
    ) -> Iterator[Outcome[Task, Value]]:
        """Yield what comes of each task as it finishes, in no order.

        Tasks are taken from ``tasks`` as workers become free. A task that raises is told of, and
        so is one whose worker dies: which one that was is found by running those that were under
        way once more, one after the other. What a task leaves behind must not mind being done
        twice.

        Parameters
        ----------
        function : callable
            Takes a task. Both are pickled where a worker is another process.
        tasks : iterable
            May be long, or made on the way; another thread may iterate over it.

        Raises
        ------
        PlacecueError
            If tasks cannot be run at all.
        Exception
            What ``tasks`` raises, after all tasks before.
        """
        work, feed = Work(function, os.getpid()), Feed(tasks)
        while not feed.ended:
            try:
                yield from self._round(work, feed)
            except GeneratorExit:
                raise
            except Exception as error:
                if not feed.open:
                    raise PlacecueError(
                        f"executor={self.name} runs no tasks ({told(error)}): try executor=none"
                    ) from error
                for number in list(feed.open):
                    yield self._alone(work, feed, number)
        if feed.error is not None:
            raise feed.error

    def _round(self, work: Work, feed: Feed[Task]) -> Iterator[Outcome[Task, Any]]:
        """Run tasks until there are none, or until the backend breaks."""
        for number, value in self._answers(work, feed):
            yield outcome_of(feed.open.pop(number), value)

    def _alone(self, work: Work, feed: Feed[Task], number: int) -> Outcome[Task, Any]:
        """Run a task that was under way when the backend broke, and nothing beside it."""
        task = feed.open.pop(number)
        try:
            [(_, value)] = self._answers(work, [(number, task)])
        except Exception as error:
            return outcome_of(task, lost(self.name, error))
        return outcome_of(task, value)

    def _answers(self, work: Work, tasks: Iterable[tuple[int, Any]]) -> Iterator[tuple[int, Any]]:
        with joblib.parallel_config(**self._backend):
            parallel = joblib.Parallel(
                n_jobs=self.jobs,
                batch_size=1,
                pre_dispatch="n_jobs",
                max_nbytes=None,
                return_as="generator_unordered" if self._generates else "list",
            )
        calls = (joblib.delayed(work)(number, task) for number, task in tasks)
        with warnings.catch_warnings():
            # What it says on a worker that died, or of tasks that are given up, we say.
            warnings.filterwarnings("ignore", module="joblib")
            yield from parallel(calls)


class Feed(Generic[Task]):
    """Numbers tasks as they are taken, and knows which are under way.

    Attributes
    ----------
    open : dict of int to object
        Tasks that were taken and not answered.
    ended : bool
        Whether there are no more.
    error : Exception or None
        What ended them early. Raised in joblib's own thread it would be lost.
    """

    def __init__(self, tasks: Iterable[Task]) -> None:
        self._tasks = enumerate(tasks)
        self.open: dict[int, Task] = {}
        self.ended = False
        self.error: Exception | None = None

    def __iter__(self) -> Iterator[tuple[int, Task]]:
        while not self.ended:
            try:
                number, task = next(self._tasks)
            except StopIteration:
                self.ended = True
                return
            except Exception as error:
                self.ended, self.error = True, error
                return
            self.open[number] = task
            yield number, task


def outcome_of(task: Any, value: Any) -> Outcome[Any, Any]:
    """Return what came of a task: a value, or a failure."""
    if isinstance(value, Failure):
        return Outcome(task, error=value.error())
    return Outcome(task, value)


def lost(executor: str, error: Exception) -> Failure:
    """Say in one line why a task has no answer though nothing was raised by it."""
    said = f"executor={executor} could not run it: {told(error)}"
    if type(error).__name__ in ("TerminatedWorkerError", "BrokenProcessPool", "KilledWorker"):
        said = (
            "its worker died (killed, out of memory, or a crash in C): fewer jobs, "
            "executor.jobs=N, take less memory"
        )
    return Failure(PlacecueError, said, told(error))
