"""The tables of docs/labelling.md."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from labelling_outcomes import Outcome, calibration_error, log_loss
from labelling_plan import Test
from tables import put, table

PAGE = Path(__file__).parents[1] / "docs" / "labelling.md"
#: What is compared, and the words after ``placecue label`` that choose it.
ACCUMULATORS = {
    "crf": [],
    "spatiotemporal": ["accumulator=spatiotemporal"],
    "hmm": ["accumulator=hmm"],
    "relaxation": ["accumulator=relaxation"],
}
#: Scores taken for as sure as those of any support vector machine.
AS_SCORED = ["accumulator.sharpness=3"]  # of the default
#: Logs by how far they are from what a model was trained on.
GROUPS: Mapping[str, Callable[[Test], bool]] = {
    "tuning, floor seen before": lambda t: t.half == "tuning" and _own(t),
    "tuning, another world": lambda t: t.half == "tuning" and " by " in t.name,
    "tuning, plans never seen": lambda t: t.half == "tuning" and _plain(t),
    "tuning, plans strangely full": lambda t: t.name.endswith("strange"),
    "tuning, another building": lambda t: t.name.startswith("drawn"),
    "demo": lambda t: t.name == "demo",
    "second_floor": lambda t: t.name.startswith("second_floor"),
    "recorded buildings": lambda t: t.truth is not None,
}
BINS = [0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]

Found = Mapping[tuple[str, str], Outcome]


def _own(test: Test) -> bool:
    return test.name.startswith("floor") and " by " not in test.name


def _plain(test: Test) -> bool:
    return test.model.startswith("plans") and not test.name.endswith("strange")


def write(page: Path, found: Found, halves: Mapping[str, Sequence[Test]]) -> None:
    """Put the tables into the page."""
    scored = [test for test in halves["reporting"] if not test.name.startswith("bag")]
    every = [*halves["tuning"], *halves["reporting"]]
    put(
        page,
        {
            "logs": _logs(found, scored),
            "rooms": _rooms(found, scored),
            "bags": _bags(found, [t for t in halves["reporting"] if t.name.startswith("bag")]),
            "calibration": _calibration(found, every),
            "reliability": _reliability(found, every),
            "tuning": _logs(found, halves["tuning"]),
        },
    )


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100 * share:.1f}"


def _logs(found: Found, tests: Sequence[Test]) -> str:
    heads = ["log", "single", "accumulator", "way", "live", "unknown", "nodes", "areas right"]
    heads += ["over 10 observations", "free space", "delay (s)", "never"]
    rows = []
    for test in tests:
        for name, words in ACCUMULATORS.items():
            of = found[" ".join(words), test.name]
            rows.append([
                test.name,
                _percent(of["single"]),
                name,
                _percent(of["way"]),
                _percent(of["live"]),
                _percent(of["unknown"]),
                _percent(of["nodes"]),
                f"{of['right']} of {of['areas']}",
                f"{of['large_right']} of {of['large']}",
                _percent(of["free"]),
                "" if of["delay"] is None else f"{of['delay']:.1f}",
                _percent(of["never"]),
            ])  # fmt: skip
    return table(heads, rows)


def _rooms(found: Found, tests: Sequence[Test]) -> str:
    """Return which rooms of the plans are called what they are."""
    rows = []
    for test in tests:
        for name, words in ACCUMULATORS.items():
            rooms = [r for r in found[" ".join(words), test.name]["rooms"] if r[2] > 10]
            cells = []
            for label in ("hallway", "room"):
                of = [told for _, true, _, told in rooms if true == label]
                cells.append(f"{of.count(label)} of {len(of)}")
            if test.truth is not None:
                rows.append([test.name, name, *cells])
    return table(["log", "accumulator", "hallways", "rooms"], rows)


def _bags(found: Found, tests: Sequence[Test]) -> str:
    rows = []
    for test in tests:
        for name, words in ACCUMULATORS.items():
            of = found[" ".join(words), test.name]
            ways, said = of["ways"], of["single_said"]
            whole = sum(length for length, _ in ways)
            told = ", ".join(f"{label} {100 * length / whole:.0f}" for length, label in ways[:4])
            beliefs = ", ".join(
                f"{label} {100 * n / sum(said.values()):.0f}" for label, n in sorted(said.items())
            )
            rows.append([test.name, beliefs, name, str(len(ways)), told])
    heads = ["log", "single beliefs (%)", "accumulator", "areas", "the largest (% of the way)"]
    return table(heads, rows)


def _said(
    found: Found, words: Sequence[str], tests: Sequence[Test], part: str
) -> list[list[float]]:
    return [row for test in tests for row in found[" ".join(words), test.name][part]]


def _calibration(found: Found, tests: Sequence[Test]) -> str:
    rows = []
    for group, belongs in GROUPS.items():
        some = [test for test in tests if belongs(test)]
        for name, words in {**ACCUMULATORS, "crf, sharpness=3": AS_SCORED}.items():
            cells = []
            for part in ("areas_said", "nodes_said"):
                said = _said(found, words, some, part)
                right = np.mean([row[1] for row in said])
                sure = np.mean([row[0] for row in said])
                cells += [
                    str(len(said)),
                    _percent(float(right)),
                    _percent(float(sure)),
                    _percent(calibration_error(said)),
                    f"{log_loss(said):.2f}",
                ]
            rows.append([group, name, *cells])
    each = ["right", "mean probability", "ECE", "log loss"]
    return table(["logs", "accumulator", "areas", *each, "nodes", *each], rows)


def _reliability(found: Found, tests: Sequence[Test]) -> str:
    rows = []
    for group, belongs in GROUPS.items():
        said = np.array(_said(found, [], [t for t in tests if belongs(t)], "nodes_said"))
        cells = []
        for low, high in pairwise(BINS):
            inside = (said[:, 0] >= low) & ((said[:, 0] < high) | (high == 1.0))
            right = said[inside, 1]
            cells.append(f"{100 * right.mean():.0f} ({len(right)})" if len(right) else "")
        rows.append([group, *cells])
    bins = [f"{100 * low:.0f} to {100 * high:.0f}" for low, high in pairwise(BINS)]
    return table(["logs", *bins], rows)
