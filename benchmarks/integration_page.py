"""Writes what benchmarks/integration_table.py found into docs/integration.md."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from integration_methods import JOINT, METHODS, SETS, decide
from integration_tests import TESTS

PAGE = Path(__file__).parents[1] / "docs" / "integration.md"
BASE = "best cue"


def write(folder: Path) -> Path:
    """Write the tables of every test that is finished into the page, each between its marks."""
    text = PAGE.read_text(encoding="utf-8")
    for test in TESTS:
        if _finished(folder, test):
            text = _placed(text, test, _table(folder, test))
            text = _placed(text, f"{test} used", _used(folder, test))
    PAGE.write_text(text, encoding="utf-8")
    return PAGE


def _finished(folder: Path, test: str) -> bool:
    return any((folder / "decisions" / test).glob("*.json"))


def _placed(text: str, name: str, table: str) -> str:
    mark = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
    return mark.sub(lambda found: f"{found[1]}{table}\n{found[2]}", text)


def _table(folder: Path, test: str) -> str:
    """Return a row a method and a column a set of cues: accuracy, interval, and how it compares."""
    names = [" + ".join(cues) for cues in SETS]
    lines = [f"| | {' | '.join(names)} |", "|---" * (len(SETS) + 1) + "|"]
    for method in METHODS:
        cells = [_cell(folder, test, cues, method) for cues in SETS]
        if any(cells):
            shown = method if method != "joint" else "joint (RBF)"
            lines.append(f"| {shown} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _cell(folder: Path, test: str, cues: Sequence[str], method: str) -> str:
    found = _found(folder, test, cues, method)
    if not found:
        return ""
    truth, scenes, decided = found
    draws = GroupBootstrap(truth, scenes, draws=2000)
    low, high = draws.interval(decided)
    mean = 100 * np.mean([(decided[truth == name] == name).mean() for name in np.unique(truth)])
    base = _found(folder, test, cues, BASE)
    sign = ""
    if base and method != BASE and len(base[0]) == len(truth):
        below, above = draws.difference(decided, base[2])
        sign = " ▲" if below > 0 else " ▼" if above < 0 else ""
    return f"{mean:.1f} [{low:.0f}, {high:.0f}]{sign}"


def _found(
    folder: Path, test: str, cues: Sequence[str], method: str
) -> tuple[Any, Any, Any] | None:
    """Return truth, scenes and decisions of all parts; None of what was not run."""
    if method == "joint" and tuple(cues) != JOINT:
        return None
    name = f"{'+'.join(cues)}_{method.replace(' ', '_')}.json"
    if not (folder / "decisions" / test / name).exists():
        return None
    parts = decide(folder, test, cues, method)
    truth, decided = (np.concatenate([p[key] for p in parts]) for key in ("truth", "decided"))
    # A sequence is a scene of each model that is tested on it.
    scenes = np.concatenate([[f"{p['part']} {s}" for s in p["scenes"]] for p in parts])
    return truth, scenes, decided


def _used(folder: Path, test: str) -> str:
    """Return for which share of samples the confidence-based scheme asks each cue (Table 2)."""
    lines = ["| cues | used for (% of samples) | ms a sample, of all cues |", "|---|---|---|"]
    for cues in SETS:
        parts = (
            decide(folder, test, cues, "confidence")
            if (folder / "decisions" / test / f"{'+'.join(cues)}_confidence.json").exists()
            else []
        )
        if not parts:
            continue
        shares = {cue: float(np.mean([p["used"][cue] for p in parts])) for cue in cues}
        costs = {cue: float(np.mean([p["costs"][cue] for p in parts])) for cue in cues}
        spent, every = sum(shares[c] * costs[c] for c in cues), sum(costs.values())
        told = ", ".join(f"{cue} {100 * shares[cue]:.0f}" for cue in sorted(cues, key=costs.get))
        lines.append(f"| {' + '.join(cues)} | {told} | {spent:.0f} of {every:.0f} |")
    return "\n".join(lines)
