"""What commands print: tables and where results are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from placecue.evaluation.tally import Tally
from placecue.pipeline import Pipeline


def console() -> Console:
    """Return the console that results go to."""
    plain = Console()
    return plain if plain.is_terminal else Console(width=140)


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], title: str = "") -> None:
    """Print a table; all columns but the first are aligned right."""
    shown = Table(title=title or None, title_justify="left", box=None, pad_edge=False)
    for number, heading in enumerate(headings):
        shown.add_column(heading, justify="left" if number == 0 else "right", no_wrap=number == 0)
    for row in rows:
        shown.add_row(*row)
    console().print(shown)


def scores(tally: Tally) -> None:
    """Print the recall of each class and the balanced accuracy, by cue and integrated."""
    rows = [
        [name, str(tally.samples(name)), *(_percent(tally.recall(m, name)) for m in tally.methods)]
        for name in tally.classes()
    ]
    accuracy = [_percent(tally.balanced_accuracy(method)) for method in tally.methods]
    rows.append(["balanced accuracy", "", *accuracy])
    table(["class (% recognised)", "samples", *tally.methods], rows)
    if tally.unlabelled or tally.unusable:
        print(f"not scored: {tally.unlabelled} without a label, {tally.unusable} unusable")


def chosen_parameters(pipeline: Pipeline) -> None:
    """Print what the parameter search of each classifier found, where there was one."""
    models = {name: classifier for name, (_, classifier) in pipeline.cues.items()}
    integrating = getattr(pipeline.integrator, "classifier_", None)
    if integrating is not None:
        models["integrator"] = integrating
    rows = []
    for name, model in models.items():
        search = getattr(model, "search_", None)
        if search:
            accuracy = search["balanced_accuracy"]
            best = accuracy.index(max(accuracy))
            found = [f"{search[key][best]:g}" if key in search else "" for key in ("C", "gamma")]
            rows.append([name, *found, _percent(max(accuracy))])
    if rows:
        table(["classifier", "C", "gamma", "balanced accuracy in cross-validation (%)"], rows)


def written(paths: Iterable[tuple[str, Path]]) -> None:
    """Print what was written where."""
    rows = list(paths)
    width = max(len(what) for what, _ in rows)
    for what, path in rows:
        print(f"{what:<{width}}  {path}")


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f}"
