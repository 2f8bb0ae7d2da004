"""Beliefs as CSV, one row an observation."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from placecue.accumulator import AreaUpdate
from placecue.atomic import replacing
from placecue.belief import Belief
from placecue.observation import Observation

COLUMNS = ("stamp", "label", "confidence", "cues", "truth", "x", "y", "theta")


class BeliefTable:
    """Writes beliefs to an open CSV file; a listener.

    Parameters
    ----------
    file : text file
        Where to. Columns: stamp (ns), label and confidence of the belief (empty where the
        observation was unusable), cues used (joined by +), true label, pose (m, rad), then the
        integrated score of each column of the layout.
    """

    def __init__(self, file: IO[str]) -> None:
        self._writer = csv.writer(file, lineterminator="\n")
        self._columns: tuple[str, ...] | None = None
        # Rows before the first belief, when the score columns are not known yet.
        self._waiting: list[list[Any]] = []

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Write one row."""
        pose, truth = observation.pose, observation.label or ""
        place = ["", "", ""] if pose is None else [repr(v) for v in (pose.x, pose.y, pose.theta)]
        if belief is None:
            row = [observation.stamp, "", "", "", truth, *place]
            if self._columns is None:
                self._waiting.append(row)
                return
            scores = [""] * len(self._columns)
        else:
            if self._columns is None:
                self._start(belief.scores.layout.columns)
            used = "+".join(belief.cues_used)
            row = [observation.stamp, belief.label, repr(belief.confidence), used, truth, *place]
            scores = [repr(float(value)) for value in belief.scores.values[0]]
        self._writer.writerow([*row, *scores])

    def _start(self, columns: tuple[str, ...]) -> None:
        self._columns = columns
        self._writer.writerow([*COLUMNS, *(f"score:{name}" for name in columns)])
        for row in self._waiting:
            self._writer.writerow([*row, *([""] * len(columns))])
        self._waiting.clear()


@contextmanager
def belief_table(path: Path) -> Iterator[BeliefTable]:
    """Open a table that appears under its name when the block succeeds."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        yield BeliefTable(file)
