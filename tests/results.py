"""Reads what commands write, with nothing of placecue's."""

from __future__ import annotations

import csv
import json
from collections import Counter
from pathlib import Path
from typing import Any

from mcap_logs import told_messages


def rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def messages(path: Path, topic: str) -> list[Any]:
    """Return the messages of a topic, as plain data."""
    return [value for at, _, value in told_messages(str(path)) if at == topic]


def check_metrics(folder: Path) -> None:
    """Compare ``metrics.json`` with what ``beliefs.csv`` adds up to."""
    table = [row for row in rows(folder / "beliefs.csv") if row["truth"] and row["label"]]
    metrics = json.loads((folder / "metrics.json").read_text())["methods"]["integrated"]
    confusion = Counter((row["truth"], row["label"]) for row in table)
    assert {(e["truth"], e["predicted"]): e["count"] for e in metrics["confusion"]} == confusion
    recall = {}
    for truth in {row["truth"] for row in table}:
        of_class = [row for row in table if row["truth"] == truth]
        recall[truth] = sum(row["label"] == truth for row in of_class) / len(of_class)
    assert metrics["recall"] == recall
    assert abs(metrics["balanced_accuracy"] - sum(recall.values()) / len(recall)) < 1e-12


def vote(row: dict[str, str], classes: list[str]) -> str:
    """Return the class with the most votes among one-against-one scores, the first of equals."""
    votes = Counter(dict.fromkeys(classes, 0))
    for column, value in row.items():
        if column.startswith("score:"):
            first, second = column.removeprefix("score:").split("|")
            votes[first if float(value) > 0 else second] += 1
    return max(classes, key=lambda name: votes[name])


def largest(row: dict[str, str]) -> str:
    """Return the class with the largest of the one-against-all scores."""
    scores = {
        column.removeprefix("score:"): float(value)
        for column, value in row.items()
        if column.startswith("score:")
    }
    return max(scores, key=lambda name: scores[name])
