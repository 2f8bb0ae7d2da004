"""Running a pipeline over a log: listeners are told, and memory does not grow with the log."""

import gc
import tracemalloc
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from placecue import AreaUpdate, Belief, Observation, Pipeline, Pose2D
from placecue.evaluation.surroundings import Surroundings
from placecue.evaluation.tally import Tally
from placecue.labelling import run_log
from placecue.logs import open_log
from placecue.logs.writing.annotated import AnnotatedLog
from placecue.logs.writing.writer import McapWriter
from placecue.storage.belief_table import belief_table
from placecue_accumulators.node import NodeLeft
from placecue_accumulators.spatiotemporal import SpatioTemporal
from toys import PLACES, Walk, pipeline

#: Observations of a round.
ROUND = 20 * len(PLACES)


class Rounds(Walk):
    """The same places again and again."""

    def at(self, number: int) -> Observation:
        seen = super().at(number)
        place = number % (self.stay * len(PLACES))
        return seen.altered("moved", pose=Pose2D(0.1 * place, 0.0, 0.0))


@pytest.fixture(scope="module")
def fitted() -> Pipeline:
    return pipeline().fit(Walk())


def accumulator() -> SpatioTemporal:
    return SpatioTemporal(boundary=NodeLeft(), accept_confidence=0.0, label_confidence=0.0)


def test_a_log_becomes_a_map(fitted: Pipeline) -> None:
    tally, surroundings, gathered = Tally(), Surroundings(), accumulator()
    run_log(fitted, Rounds(rounds=2, seed=1), [tally, surroundings], accumulator=gathered)
    labels = {area.label for area in gathered.semantic_map().areas}
    assert labels == set(PLACES)
    assert tally.balanced_accuracy("integrated") > 0.9
    assert tally.samples("kitchen") == 40
    assert {name for _, _, name in surroundings.truth} == set(PLACES)
    assert len(surroundings.points) > 100
    said = {(round(x, 1), round(y, 1)): name for x, y, name in surroundings.beliefs}
    true = {(round(x, 1), round(y, 1)): name for x, y, name in surroundings.truth}
    assert said.keys() == true.keys()
    assert sum(said[at] == true[at] for at in said) > 0.8 * len(said)


def test_a_tally_counts_what_cannot_be_scored(fitted: Pipeline) -> None:
    log = list(Walk(rounds=1, seed=1))
    log[3] = log[3].relabelled(None)
    log[7] = Observation(log[7].stamp, label="lab")
    tally = Tally()
    run_log(fitted, log, [tally])
    assert (tally.unlabelled, tally.unusable) == (1, 1)
    assert sum(tally.samples(name) for name in tally.classes()) == 78


def test_recalls_by_hand() -> None:
    tally = Tally()
    tally.counts["integrated"].update({("a", "a"): 3, ("a", "b"): 1, ("b", "b"): 1, ("b", "c"): 1})
    assert tally.recall("integrated", "a") == 0.75
    assert tally.balanced_accuracy("integrated") == pytest.approx((0.75 + 0.5) / 2)
    assert tally.recall("integrated", "c") is None


class Memory:
    """Notes what is held after each round of the walk, bytes."""

    def __init__(self) -> None:
        self.held: list[int] = []
        self.count = 0

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        self.count += 1
        if self.count % ROUND == 0:
            gc.collect()  # what waits for the collector varies
            self.held.append(tracemalloc.get_traced_memory()[0])


def test_memory_does_not_grow_with_the_log(fitted: Pipeline, tmp_path: Path) -> None:
    path, out, memory, rounds = tmp_path / "in.mcap", tmp_path / "out.mcap", Memory(), 5
    with McapWriter(path, chunk_size=2**15) as writer:
        for observation in Rounds(rounds=rounds, seed=1):
            writer.write(observation)
    tracemalloc.start()
    with (
        AnnotatedLog(out, PLACES, chunk_size=2**15) as annotated,
        belief_table(tmp_path / "b.csv") as table,
    ):
        listeners = [Tally(), annotated, table, memory]
        run_log(fitted, open_log(path), listeners, accumulator=accumulator())
    tracemalloc.stop()
    assert len(memory.held) == rounds
    # An observation with its scan takes over a kilobyte; what grows is the output's chunk index.
    assert (memory.held[-1] - memory.held[1]) / (3 * ROUND) < 500


Said = list[tuple[int, str, float, Any]]


class Heard:
    """Notes what is believed."""

    def __init__(self) -> None:
        self.said: Said = []

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        assert belief is not None
        scores = belief.scores.values.tolist()
        self.said.append((observation.stamp, belief.label, belief.confidence, scores))


def labelled(fitted: Pipeline, log: Iterable[Observation]) -> tuple[Said, dict]:
    heard = Heard()
    gathered = accumulator()
    run_log(fitted, log, [heard], accumulator=gathered, batch=4)
    return heard.said, gathered.semantic_map().to_json()


def fed(path: Path) -> Iterable[Observation]:
    """The observations of a log whose messages are handed over one at a time."""
    log = open_log(path)
    feed = log.feed()
    for message in log.file.messages(log.file.contents.channels):
        yield from filter(None, map(feed.observation, feed.push(message)))
    yield from filter(None, map(feed.observation, feed.finish()))


def test_fed_message_by_message_a_log_comes_to_the_same(fitted: Pipeline, tmp_path: Path) -> None:
    walk = tmp_path / "walk.mcap"
    with McapWriter(walk) as writer:
        for observation in Walk(rounds=1, seed=1):
            writer.write(observation)
    said, semantic_map = labelled(fitted, open_log(walk))
    assert (said, semantic_map) == labelled(fitted, fed(walk))
    assert len(said) == 80
    assert len(semantic_map["areas"]) > 4
