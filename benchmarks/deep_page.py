"""Writes what benchmarks/deep.py found into docs/deep.md."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from deep_plan import DARKER, FEW, FOLDS, METHODS, NETWORKS, SHOWN_DARK
from matplotlib.figure import Figure
from nyu_frames import ROOMS
from tables import put, table

from placecue.evaluation.group_bootstrap import GroupBootstrap
from placecue.evaluation.pictures import save_picture

PAGE = Path(__file__).parents[1] / "docs" / "deep.md"
Found = dict[str, Any]


def write(folder: Path) -> None:
    """Write the tables of all that is finished into the page."""
    dark = _joined(folder, "four")
    draw_dark(dark)
    put(
        PAGE,
        {
            "networks": _networks(folder),
            "untrained": _untrained(json.loads((folder / "untrained.json").read_text())),
            "few": _few(json.loads((folder / "few_labels.json").read_text())),
            "dark": _dark(dark),
        },
    )


def _joined(folder: Path, rooms: str) -> Found:
    """Return truth, scenes and decisions of all folds, of every run that has them all."""
    runs: dict[str, list[Found]] = {}
    for path in sorted((folder / "folds").glob(f"{rooms}_*.json")):
        runs.setdefault(path.stem.rsplit("_", 1)[0], []).append(json.loads(path.read_text()))
    whole = [run for run in runs.values() if len(run) == FOLDS]
    return {name: np.concatenate([each[name] for each in run]) for run in whole for name in run[0]}


def _accuracy(truth: Any, decided: Any) -> float:
    return float(100 * np.mean([(decided[truth == c] == c).mean() for c in np.unique(truth)]))


def _shown(draws: GroupBootstrap, decided: Any) -> str:
    low, high = draws.interval(decided)
    return f"{_accuracy(draws.truth, decided):.1f} [{low:.0f}, {high:.0f}]"


def _networks(folder: Path) -> str:
    rows = []
    for name in NETWORKS:
        of = json.loads((folder / "networks" / f"{name}.json").read_text())
        cells = []
        for rooms in ROOMS:
            parts = of[rooms]
            draws = GroupBootstrap(np.array(parts["truth"]), np.array(parts["scenes"]))
            cells.append(_shown(draws, np.array(parts["decided"])))
        rows.append([name, *cells, f"{of['ms']:.0f}"])
    return table(["", *(f"{rooms} rooms" for rooms in ROOMS), "ms a frame"], rows)


def _untrained(found: dict[str, Found]) -> str:
    rows = []
    for name, of in found.items():
        truth, decided = np.array(of["truth"]), np.array(of["decided"])
        recalls = ", ".join(
            f"{place} {100 * (decided[truth == place] == place).mean():.0f}"
            for place in np.unique(truth)
        )
        draws = GroupBootstrap(truth, np.array(of["scenes"]))
        rows.append([name, str(len(truth)), _shown(draws, decided), recalls])
    return table(["places", "frames", "balanced accuracy", "of each place"], rows)


def _few(found: dict[str, dict[str, float]]) -> str:
    rows = []
    for covariance, name in (("none", "nearest mean"), ("shared", "with a shared covariance")):
        cells = []
        for count in FEW:
            of = found.get(f"{covariance} {count or 'all'}")
            spread = f" ± {of['deviation']:.1f}" if of and of["draws"] > 1 else ""
            cells.append(f"{of['mean']:.1f}{spread}" if of else "")
        rows.append([name, *cells])
    return table(["labels a class", *(str(count or "all") for count in FEW)], rows)


def _dark(of: Found) -> str:
    rows = [
        [name, *(_cell(of, f"{name}{level}") for level in ("", *(f" / {by}" for by in DARKER)))]
        for name in METHODS
        if name in of
    ]
    return table(["light", "1", *(f"1/{by}" for by in DARKER)], rows)


def draw_dark(of: Found) -> Path:
    """Draw how much is recognised in how much light."""
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.subplots()
    lights = (1, *DARKER)
    for name in SHOWN_DARK:
        levels = ("", *(f" / {by}" for by in DARKER))
        axes.plot(lights, [_accuracy(of["truth"], of[f"{name}{each}"]) for each in levels],
                  marker="o", label=name)  # fmt: skip
    axes.set_xscale("log", base=2)
    axes.set_xticks(lights, ["1", *(f"1/{by}" for by in DARKER)])
    axes.axhline(100 / len(ROOMS["four"]), color="0.6", linestyle=":", label="chance")
    axes.set(xlabel="light in test", ylabel="balanced accuracy (%)", ylim=(20, 85))
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    return save_picture(figure, PAGE.with_name("deep_dark.png"))


def _cell(of: Found, name: str) -> str:
    return f"{_accuracy(of['truth'], of[name]):.1f}" if name in of else ""
