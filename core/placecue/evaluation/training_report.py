"""What training leaves beside a model: its parameter searches, and a reliability diagram."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.atomic import write_text
from placecue.evaluation.reliability import Reliability, draw_reliability, reliability
from placecue.evaluation.search_figure import SCORE, Results, draw_search, search_table
from placecue.evaluation.tally import INTEGRATED
from placecue.evaluation.trade_off_figure import draw_trade_off, trade_off_table
from placecue.pipeline import Pipeline
from placecue.scores import Probabilities, Scores

INTEGRATOR = "integrator"
SEARCHES, RELIABILITY, TRADE_OFF = "search", "reliability.png", "trade_off"


def write_training_report(pipeline: Pipeline, folder: Path) -> list[tuple[str, Path]]:
    """Write what training has to tell into a folder, in place of what an earlier one told.

    Parameters
    ----------
    pipeline : Pipeline
        A pipeline fresh from training.
    folder : Path
        Its model folder. ``search/NAME.md`` is the table of a parameter search, by the name of
        the cue or ``integrator``; ``search/NAME.png`` its heat map, over C and gamma or other
        numbers; ``reliability.png`` the diagram of all classifiers that give probabilities;
        ``trade_off.csv`` and ``.png`` the accuracy over cost of an integrator that need not ask
        for all cues.

    Returns
    -------
    list of (str, Path)
        What was written where, in words.
    """
    _clear(pipeline, folder)
    written = []
    searched = searches(pipeline)
    for name, results in searched.items():
        write_text(folder / SEARCHES / f"{name}.md", search_table(results))
        axes = _axes(results)
        if axes:
            draw_search(results, folder / SEARCHES / f"{name}.png", **axes, title=name)
    if searched:
        written.append(("parameter searches", folder / SEARCHES))
    measured = held_out_reliability(pipeline)
    if measured:
        draw_reliability(measured, folder / RELIABILITY, title="Reliability on held-out samples")
        written.append(("reliability diagram", folder / RELIABILITY))
    curve = getattr(pipeline.integrator, "trade_off_", None)
    if curve:
        table, picture = (folder / f"{TRADE_OFF}.{suffix}" for suffix in ("csv", "png"))
        write_text(table, trade_off_table(curve))
        written.append(("accuracy over cost", draw_trade_off(curve, picture)))
    return written


def _axes(results: Results) -> dict[str, str]:
    """Return the axes of a heat map: gamma and C, where they were not searched other numbers."""
    numbers = [
        name
        for name, values in results.items()
        if name != SCORE and all(isinstance(value, (int, float)) for value in values)
    ]
    # Gamma of a kernel inside another one is called by its place there.
    others = sorted((name for name in numbers if name != "C"), key=lambda n: "gamma" not in n)
    across, up = others[:1], ["C"] if "C" in numbers else others[1:2]
    return {axis: name for axis, names in (("across", across), ("up", up)) for name in names}


def _clear(pipeline: Pipeline, folder: Path) -> None:
    """Take away what an earlier training in the same folder told, and nothing else."""
    for name in (*pipeline.cues, INTEGRATOR):
        for suffix in ("md", "png"):
            (folder / SEARCHES / f"{name}.{suffix}").unlink(missing_ok=True)
    for name in (RELIABILITY, f"{TRADE_OFF}.csv", f"{TRADE_OFF}.png"):
        (folder / name).unlink(missing_ok=True)
    with suppress(OSError):  # it is not there, or not empty
        (folder / SEARCHES).rmdir()


def searches(pipeline: Pipeline) -> dict[str, Results]:
    """Return the points of each parameter search, by the name of the cue or ``integrator``.

    A classifier that searched has them as ``search_``: one list for each parameter, and one of
    ``balanced_accuracy``.
    """
    models: dict[str, Any] = {name: each.classifier for name, each in pipeline.cues.items()}
    models[INTEGRATOR] = getattr(pipeline.integrator, "classifier_", None)
    found = {name: getattr(model, "search_", None) for name, model in models.items()}
    return {name: results for name, results in found.items() if results and SCORE in results}


def held_out_reliability(pipeline: Pipeline) -> dict[str, Reliability]:
    """Return the reliability of each classifier that gives probabilities.

    On samples held out of everything: cues, searches and integrator. By the name of the cue, or
    ``integrated``; empty after loading a model.
    """
    judged = pipeline.judged_ or []
    found: dict[str, list[tuple[Scores, NDArray[np.str_]]]] = {}
    for part in judged:
        for cue in part.evidence.cues:
            found.setdefault(cue, []).append((part.evidence.scores(cue), part.labels))
        if pipeline.integrates:
            found.setdefault(INTEGRATED, []).append((part.scores, part.labels))
    return {
        name: reliability(*_joined(parts))
        for name, parts in found.items()
        if isinstance(parts[0][0].layout, Probabilities)
    }


def _joined(
    parts: Sequence[tuple[Scores, NDArray[np.str_]]],
) -> tuple[Scores, NDArray[np.str_]]:
    """Return the scores of all parts as one, without gaps, and the labels that go with them."""
    there = [scores.available() for scores, _ in parts]
    values = np.concatenate([s.values[rows] for (s, _), rows in zip(parts, there, strict=True)])
    labels = np.concatenate([each[rows] for (_, each), rows in zip(parts, there, strict=True)])
    return Scores(values, parts[0][0].layout), labels
