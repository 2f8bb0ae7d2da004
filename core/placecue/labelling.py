"""Runs a pipeline over a log, in one pass, telling listeners of every step."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.errors import UsageError
from placecue.observation import Observation
from placecue.pipeline import Pipeline
from placecue.progress import track
from placecue.source import guarded


class Listener(Protocol):
    """Told of every observation, in order."""

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Take in an observation, its belief (None where unusable) and what it changed."""


def run_log(
    pipeline: Pipeline,
    log: Iterable[Observation],
    listeners: Sequence[Listener],
    *,
    accumulator: Accumulator | None = None,
    batch: int = 16,
) -> None:
    """Classify a log, label its areas if there is an accumulator, and tell the listeners.

    Memory does not grow with the length of the log.

    Parameters
    ----------
    pipeline : Pipeline
        A fitted pipeline.
    log : iterable of Observation
        What to run over.
    listeners : sequence of Listener
        Tables, writers, viewers.
    accumulator : Accumulator, optional
        Gathers beliefs into areas.
    batch : int
        How many observations go through together.

    Raises
    ------
    UsageError
        If ``batch`` is no whole number of at least 1.
    """
    if not isinstance(batch, int) or batch < 1:
        raise UsageError(f"batch is {batch!r}; give a whole number of at least 1")
    observations = track(guarded(log), "classifying" if accumulator is None else "labelling")
    steps = (
        (
            (observation, belief, None)
            for observation, belief in pipeline.follow(observations, batch)
        )
        if accumulator is None
        else pipeline.label(observations, accumulator, batch)
    )
    for observation, belief, update in steps:
        for listener in listeners:
            listener.observe(observation, belief, update)
