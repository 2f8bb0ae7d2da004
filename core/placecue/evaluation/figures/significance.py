"""Which of two methods is better, over all pairs that both have results of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from placecue.evaluation.figures.drawn import Drawn
from placecue.evaluation.figures.shared import scores_of, shared
from placecue.evaluation.figures.spec import Spec
from placecue.evaluation.results.about import About, Method
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Cell, Table
from placecue.evaluation.statistics import ALPHA, SignedRank, signed_rank

#: What it takes: which two methods to compare (their parts by default), and the alternative.
KEYS = frozenset({"pairs", "alternative", "alpha"})


def draw(results: Results, spec: Spec, about: About) -> Drawn:
    """Compare methods two by two with Wilcoxon's signed-rank test.

    ``pairs`` lists which; by default each method is compared with its parts (:func:`parts`). The
    p-values are not corrected for how many tests there are.
    """
    alternative = spec.options.get("alternative", "two-sided")
    alpha = float(spec.options.get("alpha", ALPHA))
    scores = scores_of(results, spec)
    rows: list[list[Cell]] = []
    numbers: list[list[Cell]] = []
    notes = [f"Wilcoxon's signed-rank test, {alternative}, zeros split, not corrected for the "
             f"number of tests; α = {alpha:g}."]  # fmt: skip
    for method, other in asked(spec, about):
        table = shared(scores, [method, other])
        if not len(table):
            notes.append(f"'{method}' and '{other}' share no pair.")
            continue
        test = signed_rank(table[:, 0], table[:, 1], alternative)
        names: list[Cell] = [spec.label(method), spec.label(other), test.n]
        difference = 100 * test.median
        numbers.append([method, other, test.n, test.equal, difference, test.statistic, test.p,
                        alternative])  # fmt: skip
        rows.append([*names, f"{difference:+.1f}", _shown(test.p), _verdict(test, alpha)])
    columns = ["method", "against", "pairs", "equal", "median difference (points)", "T", "p",
               "alternative"]  # fmt: skip
    people = ["method", "against", "pairs", "median difference (points)", "p", "says"]
    return Drawn(Table(columns, numbers), Table(people, rows), notes=tuple(notes))


def asked(spec: Spec, about: About) -> list[tuple[str, str]]:
    """Return which two methods are compared: those that are asked for, or all with their parts."""
    listed: Sequence[Any] | None = spec.options.get("pairs")
    if listed:
        return [(a, b) for a, b in listed if a in spec.methods and b in spec.methods]
    there = {name: about.methods[name] for name in spec.methods}
    return [(name, part) for name in there for part in parts(name, there)]


def parts(name: str, methods: Mapping[str, Method]) -> list[str]:
    """Return the parts of a method that joins cues.

    They are the single-cue models of its cues, and what the same integrator makes of some of them.
    """
    whole = methods[name]
    if len(whole.cues) < 2:
        return []
    return [
        other
        for other, each in methods.items()
        if other != name
        and set(each.cues) < set(whole.cues)
        and (len(each.cues) == 1 or each.integrator == whole.integrator)
    ]


def _shown(p: float) -> str:
    return f"{p:.3f}" if p >= 0.001 else "< 0.001"


def _verdict(test: SignedRank, alpha: float) -> str:
    if test.remark:
        return test.remark
    if test.p >= alpha:
        return "no difference is shown"
    return {"greater": "better", "less": "worse"}.get(
        test.alternative, "better" if test.median > 0 else "worse"
    )
