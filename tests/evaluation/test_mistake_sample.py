"""A bounded sample of the mistakes of a run."""

from __future__ import annotations

import numpy as np
import pytest

from placecue import Belief, LaserScan, Observation, OneAgainstOne, Probabilities, Scores
from placecue.evaluation.report.sampled import MistakeSample

CLASSES = ("hall", "kitchen", "lab", "office")


def observed(number: int, truth: str | None, image: bool = True) -> Observation:
    angles = np.array([-1.0, 0.0, 1.0])
    return Observation(
        number,
        image=np.full((48, 64, 3), number % 256, np.uint8) if image else None,
        scan=LaserScan(angles, np.full(3, 2.0), 0.0, 10.0),
        label=truth,
        log_name="run.mcap",
    )


def believed(number: int, label: str) -> Belief:
    def scores(best: str) -> Scores:
        values = [[0.7 if name == best else 0.1 for name in CLASSES]]
        return Scores(np.array(values), Probabilities(CLASSES))

    cues = {"crfh": scores(label), "laser": scores("office")}
    return Belief(number, scores(label), label, 0.7, cues)


def test_right_ones_and_what_cannot_be_judged_are_none() -> None:
    sample = MistakeSample()
    sample.observe(observed(0, "lab"), believed(0, "lab"), None)
    sample.observe(observed(1, None), believed(1, "lab"), None)
    sample.observe(observed(2, "lab"), None, None)
    assert sample.total == 0
    assert sample.mistakes.shown == []


def test_what_one_tells() -> None:
    sample = MistakeSample()
    sample.observe(observed(3, "office"), believed(3, "lab"), None)
    [mistake] = sample.mistakes.shown
    assert (mistake.recording, mistake.stamp, mistake.truth) == ("run.mcap", 3, "office")
    assert (mistake.decided, mistake.confidence) == ("lab", 0.7)
    assert mistake.said == {"lab": ["crfh", "integrated"], "office": ["laser"]}
    assert list(mistake.right) == ["laser"]
    assert mistake.image.startswith(b"\xff\xd8")
    assert mistake.scan is not None
    assert np.allclose(np.hypot(*mistake.scan.T), 2.0)
    crfh, laser, integrated = mistake.scores
    assert [each.title for each in (crfh, laser, integrated)] == ["crfh", "laser", "integrated"]
    best = max(laser.bars, key=lambda bar: bar.value)
    assert (best.name, best.value, best.share, best.right) == ("office", 0.7, 1.0, True)
    assert not max(crfh.bars, key=lambda bar: bar.value).right


def test_memory_is_bounded_however_long_the_log_is() -> None:
    sample = MistakeSample(most=20, each=6)
    for number in range(4000):
        truth = CLASSES[number % 4]
        wrong = CLASSES[(number + 1 + number // 4 % 3) % 4]
        sample.observe(observed(number, truth, image=False), believed(number, wrong), None)
        assert len(sample.mistakes.shown) <= 20
    found = sample.mistakes
    assert found.total == sample.total == 4000
    # All twelve kinds are there, and they come from the whole of the log.
    assert len({(each.truth, each.decided) for each in found.shown}) == 12
    assert max(each.stamp for each in found.shown) > 2000


def test_a_kind_is_spread_over_time() -> None:
    sample = MistakeSample(each=4)
    for number in range(100):
        sample.observe(observed(number, "lab", image=False), believed(number, "hall"), None)
    assert [each.stamp for each in sample.mistakes.shown] == [0, 32, 64, 96]


@pytest.mark.parametrize("kinds", [30, 200])
def test_more_kinds_than_there_is_room_for(kinds: int) -> None:
    sample = MistakeSample(most=10)
    names = tuple(f"room {n}" for n in range(kinds))
    for number, name in enumerate(names):
        scores = Scores(np.eye(kinds)[[0]], Probabilities(names))
        belief = Belief(number, scores, "elsewhere", 1.0, {"laser": scores})
        sample.observe(observed(number, name, image=False), belief, None)
    assert len(sample.mistakes.shown) == 10
    assert sample.mistakes.total == kinds


def test_scores_of_pairs_are_shown_by_class() -> None:
    # The lab beats all; the hall beats nobody.
    values = {("hall", "kitchen"): -1, ("hall", "lab"): -1, ("hall", "office"): -1,
              ("kitchen", "lab"): -1, ("kitchen", "office"): 1, ("lab", "office"): 1}  # fmt: skip
    layout = OneAgainstOne(CLASSES)
    row = [[float(values[tuple(name.split("|"))]) for name in layout.columns]]  # type: ignore[index]
    scores = Scores(np.array(row), layout)
    sample = MistakeSample()
    sample.observe(observed(0, "hall"), Belief(0, scores, "lab", 1.0, {"laser": scores}), None)
    [[title, bars]] = sample.mistakes.shown[0].scores
    assert title == "laser, ranks"
    assert [bar.name for bar in bars] == ["lab", "kitchen", "office", "hall"]
    assert [bar.right for bar in bars] == [False, False, False, True]
