"""The tables of docs/cues_and_classifiers.md, written between their markers."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path
from statistics import mean
from typing import Any

from cues_and_classifiers_plan import (
    BUILDINGS,
    EXTENSIONS,
    KERNELS,
    LONG,
    PARTS,
    ROWS,
    SHORT,
    TRIED,
    TWO,
    Row,
)
from cues_and_classifiers_results import (
    Cell,
    Results,
    balanced_accuracy,
    chosen_inside,
    recalls,
    standard_error,
)

#: The multi-class extension that does best inside the training samples of each fold.
SEARCHED = "searched"
HEADS = {
    "oaa": "SVM, oaa",
    "modified_oaa": "SVM, modified oaa",
    "oao": "SVM, oao",
    SEARCHED: "SVM, searched",
    "adaboost": "AdaBoost",
    "adaboost_probability": "AdaBoost, probabilities",
    "forest": "random forest",
    "logistic": "logistic regression",
    "knn": "5 neighbours",
}
PLACES = ("room", "hallway", "doorway")
#: What a quick prototype reached on the four rooms, percent.
PROTOTYPE = {
    "crfh": 37,
    "sift": 43,
    "laser, group": 50,
    "gist": 46,
    "color_histogram": 46,
    "fisher_vector": 55,
}


def write(page: Path, results: Results, parts: Sequence[str]) -> None:
    """Put the tables of some parts into the page, as far as they are finished, and print them."""
    text = page.read_text()
    for name, table in TABLES.items():
        if ("nyuv2" if name in OF_FRAMES else "maps_360") not in parts:
            continue
        made = table(results)
        text = filled(text, name, made)
        print(f"{name}\n\n{made}\n")
    page.write_text(text)


def filled(text: str, name: str, table: str) -> str:
    """Return a page with a table between its two markers.

    Raises
    ------
    ValueError
        If the markers are not there.
    """
    start, end = f"<!-- table {name} -->", "<!-- end -->"
    pattern = re.compile(f"{re.escape(start)}.*?{re.escape(end)}", re.DOTALL)
    if not pattern.search(text):
        raise ValueError(f"the page has no place for the table {name}: write {start} and {end}")
    return pattern.sub(lambda _: f"{start}\n{table}\n{end}", text)


class Notes:
    """Numbered reasons for cells that cannot be."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def number(self, text: str) -> int:
        """Return the number of a reason, a new one for a new text."""
        if text not in self.texts:
            self.texts.append(text)
        return self.texts.index(text) + 1


def markdown(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _folds(results: Results, row: Row, test: str, column: str) -> list[dict[str, Any]] | None:
    """Return what is told of the folds of a cell; None if one is not finished."""
    if column == SEARCHED:
        each = [_folds(results, row, test, extension) for extension in EXTENSIONS]
        known = [folds for folds in each if folds is not None]
        return chosen_inside(known) if len(known) == len(each) else None
    return results.folds(Cell(row.part, row.name, test, column), PARTS[row.part].outer)


def _cell(results: Results, row: Row, test: str, column: str, notes: Notes) -> tuple[str, float]:
    """Return a figure with its standard error, or why there is none."""
    if column in KERNELS and column == row.kernel:
        column = "oaa"
    if column not in (*row.columns[test], SEARCHED):
        return "", 0.0
    folds = _folds(results, row, test, column)
    if folds is None:
        return "not yet", 0.0
    if "error" in folds[0]:
        return f"– ({notes.number(folds[0]['error'])})", 0.0
    return f"{balanced_accuracy(folds):.1f}", standard_error(folds)


def _grid(results: Results, rows: Sequence[Row], test: str, columns: Sequence[str]) -> str:
    """Return a table of rows and columns, with notes below."""
    notes, errors, lines = Notes(), [], []
    for row in rows:
        cells = [_cell(results, row, test, column, notes) for column in columns]
        errors += [error for _, error in cells if error]
        lines.append([row.name, *(text for text, _ in cells)])
    below = [f"({number}) {text}" for number, text in enumerate(notes.texts, start=1)]
    if errors:
        spread = f"{min(errors):.1f} to {max(errors):.1f}"
        how = "over scenes" if rows[0].part == "nyuv2" else "were the samples independent"
        below.insert(0, f"Standard error of a figure, {how}: {spread}.")
    head = ["cue", *(HEADS.get(column, column) for column in columns)]
    return "\n\n".join([markdown(head, lines), *below])


def _rows(test: str) -> list[Row]:
    return [row for row in ROWS if test in row.columns]


def _four(results: Results) -> str:
    """Return the table of the four rooms, with what the prototype reached."""
    table = _grid(results, _rows("four"), "four", _with_search(SHORT))
    lines = []
    for line in table.splitlines():
        name = line.strip("| ").split(" | ")[0]
        more = {"cue": "prototype, oaa", "---": "---"}.get(name, str(PROTOTYPE.get(name, "")))
        lines.append(f"{line} {more} |" if line.startswith("|") else line)
    return "\n".join(lines)


def _tried(results: Results) -> str:
    """Return what variants of a cue reach inside the training samples, and on the held-out ones."""
    lines = []
    for cue, rows in TRIED.items():
        known = [
            folds for row in rows if (folds := _folds(results, row, "four", "oaa")) is not None
        ]
        if len(known) < len(rows):
            lines.append([cue, "not yet", ""])
            continue
        lines += [[row.name, *_both(folds)] for row, folds in zip(rows, known, strict=True)]
        lines.append([f"**{cue}, chosen inside each fold**", *_both(chosen_inside(known))])
    return markdown(["cue", "inside the training samples", "held-out samples"], lines)


def _both(folds: list[dict[str, Any]]) -> list[str]:
    inside = 100 * mean(fold["inner"] for fold in folds)
    return [f"{inside:.1f}", f"{balanced_accuracy(folds):.1f}"]


def _with_search(columns: Sequence[str]) -> list[str]:
    """Return columns with that of a search over the multi-class extensions put after these."""
    return [*EXTENSIONS, SEARCHED, *columns[len(EXTENSIONS) :]]


def _classes(results: Results) -> str:
    """Return which share of each class of the plans is recognised, for rows as shipped."""
    lines = []
    for row in (row for row in _rows("three") if not row.svm):
        for column in ("oaa", "adaboost"):
            folds = _folds(results, row, "three", column)
            of_class = recalls(folds) if folds else {}
            shares = [f"{100 * of_class[name][0]:.1f}" if folds else "" for name in PLACES]
            lines.append([row.name, HEADS[column], *shares])
    return markdown(["cue", "classifier", *PLACES], lines)


def _buildings(results: Results) -> str:
    """Return the balanced accuracy in each building, and its share of hallways recognised."""
    lines = []
    rows = [row for row in _rows("three") if row.part == "maps_360"]
    for row, column in product(rows, ("oaa", "adaboost")):
        folds = _folds(results, row, "three", column) or []
        cells = [
            f"{balanced_accuracy([fold]):.0f} ({100 * recalls([fold])['hallway'][0]:.0f})"
            for fold in folds
        ]
        lines.append([row.name, HEADS[column], *(cells or ["not yet"] * len(BUILDINGS))])
    return markdown(["cue", "classifier", *BUILDINGS], lines)


#: The tables of frames; the others are of floor plans.
OF_FRAMES = ("eight", "kernels", "four", "tried")
TABLES: dict[str, Callable[[Results], str]] = {
    "eight": lambda results: _grid(results, _rows("eight"), "eight", _with_search(LONG)),
    "kernels": lambda results: _grid(results, _rows("eight"), "eight", KERNELS),
    "four": _four,
    "tried": _tried,
    "three": lambda results: _grid(results, _rows("three"), "three", list(HEADS)),
    "classes": _classes,
    "buildings": _buildings,
    "two": lambda results: _grid(results, _rows("two"), "two", TWO),
}
