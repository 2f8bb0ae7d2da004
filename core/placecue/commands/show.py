"""What commands print of scores and of training."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from placecue.commands.tables import table, written
from placecue.evaluation.protocol.edges import end_of
from placecue.evaluation.search_figure import SCORE, as_text
from placecue.evaluation.tally import INTEGRATED, Tally
from placecue.evaluation.training_report import searches
from placecue.guard import call
from placecue.pipeline import Pipeline
from placecue.semantic_map import UNKNOWN

#: A value at the end of a grid that is so little better than the others says nothing of more.
AS_GOOD = 0.005


def scores(tally: Tally) -> None:
    """Print the recall of each class and the balanced accuracy, by cue and integrated.

    Where the pipeline can say "unknown", also how much of each class it did.
    """
    headings = ["class (% recognised)", "samples", *tally.methods]
    rows = [
        [name, str(tally.samples(name)), *(_percent(tally.recall(m, name)) for m in tally.methods)]
        for name in tally.classes()
    ]
    accuracy = [_percent(tally.balanced_accuracy(method)) for method in tally.methods]
    rows.append(["balanced accuracy", "", *accuracy])
    if tally.says_unknown:
        headings.append(f"{UNKNOWN} (%)")
        for row, name in zip(rows, tally.classes(), strict=False):
            row.append(_percent(tally.unknown(INTEGRATED, name)))
    table(headings, rows)
    if tally.says_unknown:
        share, right = tally.unknown(INTEGRATED), tally.accuracy_of_named(INTEGRATED)
        print(f"{UNKNOWN}: {_percent(share)} % of all; of the others {_percent(right)} % are right")
    if any(count < tally.believed for count in tally.used.values()):
        shares = (f"{cue} {100 * n / tally.believed:.1f} %" for cue, n in tally.used.items())
        print(f"cues used: {', '.join(shares)} of {tally.believed} observations, and scored there")
    if tally.unlabelled or tally.unusable:
        print(f"not scored: {tally.unlabelled} without a label, {tally.unusable} unusable")


def training(pipeline: Pipeline, report: Sequence[tuple[str, Path]]) -> None:
    """Print what training found, and where it wrote the rest."""
    chosen_parameters(pipeline)
    for line in at_edges(pipeline):
        print(line)
    learned: str = call(pipeline.integrator, "summary")
    if learned:
        print(f"integrator: {learned}")
    found = pipeline.rejection_
    if found is not None:
        print(
            f"{UNKNOWN}: below a confidence of {found.threshold:.3g}; on held-out samples this "
            f"keeps {_percent(found.accept_rate)} % of the {found.n_right} right decisions and "
            f"accepts {_percent(found.false_accept_rate)} % of the {found.n_wrong} wrong ones"
        )
    measured = pipeline.calibration_
    if measured is not None:
        print(
            f"probabilities: a score of 1 is worth log odds of {measured.sharpness:.3g}; log loss "
            f"{measured.log_loss:.3f} on {measured.n} held-out samples"
        )
    if report:
        written(report)


def chosen_parameters(pipeline: Pipeline) -> None:
    """Print what the parameter search of each classifier found, where there was one."""
    found = searches(pipeline)
    names = list(dict.fromkeys(name for each in found.values() for name in each if name != SCORE))
    rows = []
    for classifier, results in found.items():
        best = int(np.argmax(results[SCORE]))
        chosen = [as_text(results[name][best]) if name in results else "" for name in names]
        rows.append([classifier, *chosen, _percent(results[SCORE][best])])
    if rows:
        table(["classifier", *names, "balanced accuracy in cross-validation (%)"], rows)


def best_of_searches(pipeline: Pipeline) -> dict[str, float]:
    """Return the best balanced accuracy that each search found."""
    return {name: float(max(results[SCORE])) for name, results in searches(pipeline).items()}


def accuracy(tally: Tally) -> dict[str, float]:
    """Return the balanced accuracy of the whole pipeline; nothing where there are no labels."""
    return {"balanced accuracy": tally.balanced_accuracy(INTEGRATED)} if tally.counts else {}


def at_edges(pipeline: Pipeline) -> list[str]:
    """Return a line for each parameter whose best value is the first or last of its grid."""
    lines = []
    for classifier, results in searches(pipeline).items():
        best = int(np.argmax(results[SCORE]))
        for name, values in results.items():
            edge = None if name == SCORE else _edge(values, results[SCORE])
            if edge:
                where = classifier if classifier == "integrator" else f"cues.{classifier}"
                beyond = f"{where}.classifier.search.{name}=[...]"
                lines.append(
                    f"note: {name} = {as_text(values[best])} of {classifier} is the {edge} of its "
                    f"grid; better ones may lie beyond: {beyond}"
                )
    return lines


def _edge(values: Sequence[Any], scores: Sequence[float]) -> str | None:
    """Return which end of a grid all the best points are at; None where one lies within.

    None, too, where the value beside the end is as good but for :data:`AS_GOOD`.
    """
    points = list(zip(values, scores, strict=True))
    best = {value for value, score in points if score == max(scores)}
    end = end_of(values, best)
    if end is None:
        return None
    others = max(score for value, score in points if value not in best)
    return end if max(scores) - others >= AS_GOOD else None


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f}"
