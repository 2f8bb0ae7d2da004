"""Machines that LIBSVM left unfinished: counted, and told once a training."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps
from threading import Lock
from typing import Any, TypeVar

log = logging.getLogger(__name__)

#: The classes that a machine parts: one that is held against all others, or two.
Parted = tuple[int, ...]
Train = TypeVar("Train", bound=Callable[..., Any])

#: Measured: machines on CRFH and GIST (330 frames, chi2, rbf, linear and hi kernels, C from 1 to
#: 10,000) need 1 to 40 iterations a sample. The hardest on a shipped grid part a few scores that
#: overlap, with a linear kernel and C = 100: up to 325,000, a sixth of this. At C = 1000 some of
#: those need 3 million and are stopped.
ITERATIONS = 2_000_000
#: For large problems, whose iterations grow with their samples.
ITERATIONS_PER_SAMPLE = 500
#: So many machines are named, the others counted.
_NAMED = 3


def iteration_limit(n: int) -> int:
    """Return after how many iterations LIBSVM stops on n samples."""
    return max(ITERATIONS, ITERATIONS_PER_SAMPLE * n)


class Unfinished:
    """What LIBSVM left unfinished in one training.

    Attributes
    ----------
    machines : int
        How many machines were trained.
    costs : dict of float to list of (int, ...)
        By C, the classes that the unfinished ones part, as often as they were left so.
    most : int
        The largest number of iterations.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self.machines = 0
        self.most = 0
        self.costs: dict[float, list[Parted]] = {}

    def add(self, C: float, machines: int, unfinished: Sequence[Parted], iterations: int) -> None:
        """Count machines of one C, and which of them were left unfinished."""
        with self._lock:  # the folds of a search are trained side by side
            self.machines += machines
            if unfinished:
                self.most = max(self.most, iterations)
                self.costs.setdefault(C, []).extend(unfinished)

    def tell(self, classes: Sequence[str] | None = None) -> None:
        """Log one line, if there is anything to tell.

        Parameters
        ----------
        classes : sequence of str, optional
            What the classes are called; otherwise they go by their numbers.
        """
        count = sum(map(len, self.costs.values()))
        if not count:
            return
        costs = ", ".join(f"{C:g}" for C in sorted(self.costs))
        log.warning(
            f"LIBSVM stopped {count} of {self.machines} machines after {self.most} iterations, "
            f"before they converged: {self._names(classes)}, at C={costs}; scale the features "
            "(scaling), or choose a smaller C or another kernel"
        )

    def _names(self, classes: Sequence[str] | None) -> str:
        parted = sorted({each for of_cost in self.costs.values() for each in of_cost})
        named = [
            " against ".join(str(code) if classes is None else classes[code] for code in each)
            + (" against the rest" if len(each) == 1 else "")
            for each in parted[:_NAMED]
        ]
        more = f" and {len(parted) - _NAMED} more" if len(parted) > _NAMED else ""
        return ", ".join(named) + more


#: The trainings going on, the innermost last. Those of all threads: a search's have no other tie.
_trainings: list[Unfinished] = []


@contextmanager
def training() -> Iterator[Unfinished]:
    """Gather what is left unfinished by the machines that are trained inside."""
    found = Unfinished()
    _trainings.append(found)
    try:
        yield found
    finally:
        _trainings.remove(found)


def note(C: float, machines: int, unfinished: Sequence[Parted], iterations: int) -> None:
    """Count machines in the training that goes on; outside of one, tell at once."""
    if _trainings:
        _trainings[-1].add(C, machines, unfinished, iterations)
    else:
        alone = Unfinished()
        alone.add(C, machines, unfinished, iterations)
        alone.tell()


def told_once(train: Train) -> Train:
    """Tell once, when a classifier's method is done, what it left unfinished."""

    @wraps(train)
    def once(self: Any, *arguments: Any, **options: Any) -> Any:
        with training() as found:
            result = train(self, *arguments, **options)
        found.tell(self.class_names)
        return result

    return once  # type: ignore[return-value]
