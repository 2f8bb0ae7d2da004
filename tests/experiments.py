"""A small experiment: four logs of a robot in four rooms, two cues, two integrators."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from placecue.components.manager import current_plugins
from placecue.errors import PlacecueError
from placecue.evaluation.protocol.bench import Bench
from placecue.evaluation.protocol.evaluation import Evaluation
from placecue.evaluation.protocol.methods import Joined, Methods, SingleCue
from placecue.evaluation.protocol.plan import Protocol
from placecue.evaluation.protocol.recordings import Recorded
from placecue.evaluation.results.result import Result
from rooms import Rooms, write_log

LINEAR = {"plugin": "svm", "kernel": {"plugin": "linear"}, "C": 1.0, "scaling": "standard"}
SEARCHED = {**LINEAR, "search": {"C": [0.1, 1.0, 10.0]}}
LASER = SingleCue("laser", "cue=laser", {"plugin": "laser"}, LINEAR)
HISTOGRAM = {"plugin": "svm", "kernel": {"plugin": "chi2", "gamma": 1.0}, "C": 10.0}
COLOUR = SingleCue("colour", "cue=color_histogram", {"plugin": "color_histogram"}, HISTOGRAM)
GDAS = Joined("both, gdas", ("laser", "colour"), "integrator=gdas", {"plugin": "gdas"})
DAS = Joined(
    "both, svm_das",
    ("laser", "colour"),
    "integrator=svm_das",
    {"plugin": "svm_das", "classifier": {"plugin": "svm", "kernel": "rbf", "multiclass": "oao"}},
)
BOTH = Methods({m.name: m for m in (LASER, COLOUR)}, {j.name: j for j in (GDAS, DAS)})
RULE = {"same": ["light"]}


@dataclass
class Counts:
    """A board that keeps what it is told."""

    totals: dict[str, int] = field(default_factory=dict)
    done_: list[tuple[str, bool]] = field(default_factory=list)
    steps: list[tuple[str, int, int]] = field(default_factory=list)

    def step(self, name: str, done: int = 0, total: int = 0) -> None:
        self.steps.append((name, done, total))

    def add(self, experiment: str, total: int, done: int = 0) -> None:
        self.totals[experiment] = total - done

    def done(self, experiment: str, failed: bool = False) -> None:
        self.done_.append((experiment, failed))


@dataclass
class Outcome:
    task: Any
    value: Any = None
    error: PlacecueError | None = None


class Here:
    """Runs tasks one after the other."""

    def __init__(self) -> None:
        self.tasks: list[str] = []

    def map(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Iterator[Outcome]:
        for task in tasks:
            self.tasks.append(function.__name__)
            yield Outcome(task, function(task))


def logs(folder: Path, count: int = 4) -> list[Path]:
    return [write_log(folder / f"log{n}.mcap", Rooms(seed=n)) for n in range(count)]


def recordings(paths: Iterable[Path]) -> tuple[Recorded, ...]:
    """Logs 0 and 1 by day, 2 and 3 by night."""
    return tuple(
        Recorded(
            path.stem,
            "",
            {"plugin": "mcap", "path": str(path)},
            None,
            {"light": "day" if n < 2 else "night"},
        )
        for n, path in enumerate(paths)
    )


def evaluation(
    out: Path,
    paths: Iterable[Path],
    methods: Methods = BOTH,
    pairs: Any = "all",
    protocol: Protocol | None = None,
    **bench: Any,
) -> Evaluation:
    given = {"every": 1, "folds": {"plugin": "interleaved"}, "labels": {}, **bench}
    return Evaluation(
        Bench(str(out), str(out / "cache"), recordings(paths), **given),
        pairs,
        methods,
        Protocol() if protocol is None else protocol,
        {},
        current_plugins().registry,
    )


def run(each: Evaluation, executor: Any = None) -> dict[tuple[str, str], Result]:
    """Run an experiment; return its results by method and pair."""
    found: dict[tuple[str, str], Result] = {}
    each.run(
        Here() if executor is None else executor,
        Counts(),
        lambda result: found.__setitem__((result.method, str(result.pair)), result),
    )
    return found
