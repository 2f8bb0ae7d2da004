"""How far scores can be trusted: intervals over scenes or recordings drawn anew."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.pooled import Pooled, pooled, shared
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.group_bootstrap import GroupBootstrap
from placecue.evaluation.results.about import About
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table

#: What it takes: methods by the column and the row that they stand in, as bars do.
KEYS = frozenset({"groups"})
#: How often groups are drawn.
DRAWS = 2000


class Against(NamedTuple):
    """How a method compares with another on the samples that both have, in points."""

    other: str
    difference: float
    low: float
    high: float

    @property
    def mark(self) -> str:
        """An arrow where the interval leaves out 0."""
        return " ▲" if self.low > 0 else " ▼" if self.high < 0 else ""


class Interval(NamedTuple):
    """A balanced accuracy over the samples of all pairs, %, and its 95 % interval."""

    accuracy: float
    low: float
    high: float
    groups: int
    samples: int
    against: Against | None

    def __str__(self) -> str:
        mark = self.against.mark if self.against else ""
        return f"{self.accuracy:.1f} [{self.low:.0f}, {self.high:.0f}]{mark}"


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Return the balanced accuracy of each method with its 95 % interval, as a table.

    Samples of all pairs of an experiment are put together; scenes (where a source knows none:
    recordings) are drawn anew within each class. A method that joins cues is compared with the
    best of its cues on the same draws. ``groups`` (name of a column → name of a row → method)
    makes a table of integrators by sets of cues.
    """
    found = {
        (method, experiment): each
        for experiment in spec.experiments
        for method, each in _of_experiment(results, spec, about, experiment)
    }
    numbers: list[list[Cell]] = [
        [method, experiment, each.samples, each.groups, each.accuracy, each.low, each.high,
         *(each.against or (None,) * 4)]
        for (method, experiment), each in found.items()
    ]  # fmt: skip
    columns = ["method", "experiment", "samples", "groups", "balanced accuracy (%)", "low", "high",
               "best cue", "difference (points)", "difference low", "difference high"]  # fmt: skip
    table = _by_group(spec, found) if spec.options.get("groups") else _by_experiment(spec, found)
    return Drawn(Table(columns, numbers), table, notes=_notes(found))


def _of_experiment(
    results: Results, spec: Spec, about: About, experiment: str
) -> Iterator[tuple[str, Interval]]:
    of_method = {
        method: pooled(results, method, experiment)
        for method in about.methods
        if results.of(method, experiment)
    }
    for method in spec.methods:
        if method in of_method:
            cues = [cue for cue in about.methods[method].cues if cue in of_method]
            best = max(cues, key=lambda cue: of_method[cue].accuracy, default=None)
            yield method, _interval(of_method, method, best if len(cues) > 1 else None)


def _interval(of_method: Mapping[str, Pooled], method: str, best: str | None) -> Interval:
    said = of_method[method]
    draws = GroupBootstrap(said.truth, said.groups, DRAWS)
    low, high = draws.interval(said.decided)
    against = None if best is None else _against(best, said, of_method[best])
    return Interval(said.accuracy, low, high, draws.smallest, len(said), against)


def _against(name: str, one: Pooled, other: Pooled) -> Against | None:
    one, other = shared(one, other)
    if not len(one):
        return None
    draws = GroupBootstrap(one.truth, one.groups, DRAWS)
    interval = draws.difference(one.decided, other.decided)
    return Against(name, one.accuracy - other.accuracy, *interval)


def _by_experiment(spec: Spec, found: Mapping[tuple[str, str], Interval]) -> Table:
    rows: list[list[Cell]] = [
        [spec.label(method), *(_shown(found.get((method, e))) for e in spec.experiments)]
        for method in spec.methods
    ]
    return Table(["method", *spec.experiments], rows)


def _by_group(spec: Spec, found: Mapping[tuple[str, str], Interval]) -> Table:
    groups: Mapping[str, Mapping[str, str]] = spec.options["groups"]
    bars = list(dict.fromkeys(bar for each in groups.values() for bar in each))
    rows: list[list[Cell]] = []
    for experiment in spec.experiments:
        for bar in bars:
            of_group = [found.get((each.get(bar, ""), experiment)) for each in groups.values()]
            rows.append([experiment, bar, *map(_shown, of_group)])
    return Table(["experiment", "method", *groups], rows)


def _shown(interval: Interval | None) -> str | None:
    return None if interval is None else str(interval)


def _notes(found: Mapping[tuple[str, str], Interval]) -> tuple[str, ...]:
    notes = [
        "Samples of all pairs together; 95 % intervals over scenes (or recordings) drawn anew; ▲ "
        "▼: better, worse than the best of its cues, an interval of the difference that leaves "
        "out 0"
    ]
    few = min((each.groups for each in found.values()), default=0)
    if few < 5:
        notes.append(f"A class comes from {few} of them only: its part of an interval says little")
    return tuple(notes)
