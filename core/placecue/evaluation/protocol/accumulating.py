"""A task: accumulate what a method says of a test recording, and judge the map that comes of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.contracts import area_update
from placecue.contracts import semantic_map as checked_map
from placecue.errors import DataError, PlacecueError
from placecue.evaluation.area_scores import AreaScores, AreaTally
from placecue.evaluation.protocol.bench import Bench
from placecue.evaluation.protocol.scores_store import Said, ScoresStore
from placecue.evaluation.results.areas import AreaResult, AreaStore
from placecue.evaluation.results.result import Pair
from placecue.free_space import FreeSpace, Grid
from placecue.guard import call
from placecue.observation import Observation
from placecue.semantic_map import SemanticMap


@dataclass(frozen=True)
class AreasTask:
    """What one method says of one test, for every accumulator.

    Parameters
    ----------
    bench : Bench
        Its accumulators label.
    pair : Pair
    method : str
        The method's name.
    scores : str
        Digest of what it says.
    digests : mapping of str to str
        Of each result, by the accumulator's name.
    """

    bench: Bench
    pair: Pair
    method: str
    scores: str
    digests: Mapping[str, str]

    def __str__(self) -> str:
        return f"areas of {self.pair.test} by {self.method}"


def accumulated(task: AreasTask) -> dict[str, str]:
    """Label the areas of a test by every accumulator, and keep what the maps are worth.

    Returns
    -------
    dict of str to str
        Why an accumulator has no result; empty where all went well.
    """
    registry, store = current_plugins().registry, AreaStore(task.bench.folder)
    said = ScoresStore(task.bench.folder, registry).load(task.scores)
    seen = [_bare(each) for each in task.bench.open(task.pair.world, task.pair.test)]
    beliefs, free = _beliefs(said), _free_space(seen)
    wrong = {}
    for name, digest in task.digests.items():
        try:
            accumulator = build(task.bench.accumulators[name], "accumulator", registry, name)
            scores = _scores(accumulator, seen, beliefs, free)
            store.save(digest, AreaResult(task.pair, task.method, name, scores))
        except PlacecueError as error:
            wrong[name] = f"{task.method}, {name} on {task.pair.test}: {error}"
    return wrong


def _bare(seen: Observation) -> Observation:
    """Return an observation without its image, which accumulators do not look at."""
    return Observation(seen.stamp, scan=seen.scan, pose=seen.pose, label=seen.label)


def _beliefs(said: Said) -> dict[int, Belief]:
    """Return the belief at each position of the recording that there is one of."""
    there = np.flatnonzero(said.scores.available())
    if not len(there):
        raise DataError("it says nothing of the test")
    decision = said.scores[there].decide()
    return {
        int(said.positions[row]): Belief(
            int(said.stamps[row]),
            said.scores[row : row + 1],
            str(decision.labels[i]),
            float(decision.confidence[i]),
            {},
        )
        for i, row in enumerate(there.tolist())
    }


def _free_space(seen: list[Observation]) -> Grid | None:
    space = FreeSpace()
    for each in seen:
        space.observe(each)
    return space.grid()


def _scores(
    accumulator: Accumulator,
    seen: list[Observation],
    beliefs: Mapping[int, Belief],
    free: Grid | None,
) -> AreaScores:
    tally = AreaTally()
    for position, each in enumerate(seen):
        belief = beliefs.get(position)
        update: AreaUpdate | None = call(
            accumulator, "update", each, belief, check=area_update, at=each
        )
        tally.observe(each, belief, update)
    made: SemanticMap = call(accumulator, "semantic_map", check=checked_map)
    return tally.scores(made, free)
