"""Intervals over scenes, against draws counted by hand."""

from collections import Counter
from itertools import product

import numpy as np
import pytest

from placecue.evaluation.group_bootstrap import GroupBootstrap

DRAWS = 20_000


def test_scenes_are_drawn_and_not_frames():
    # Class a: scene 1 is right twice, scene 2 wrong twice: its recall is 0 in a quarter of the
    # draws, 1/2 in a half, 1 in a quarter. Class b is always right, so that the balanced accuracy
    # is 50, 75 or 100; its variance is 25**2 / 2.
    truth, scenes = [*"aaaabb"], [1, 1, 2, 2, 3, 4]
    drawn = GroupBootstrap(truth, scenes, draws=DRAWS)
    predicted = [*"aabbbb"]
    shares = {value: n / DRAWS for value, n in Counter(drawn.accuracies(predicted)).items()}
    assert shares == pytest.approx({50.0: 0.25, 75.0: 0.5, 100.0: 0.25}, abs=0.02)
    assert drawn.error(predicted) == pytest.approx(25 / 2**0.5, abs=0.3)
    assert drawn.interval(predicted) == (50.0, 100.0)
    assert drawn.interval(predicted, level=40.0) == (75.0, 75.0)


def test_scenes_count_by_their_frames_and_classes_alike():
    # Class a: scenes of 3, 1 and 2 frames with 3, 0 and 1 right; class b: of 1 and 1 with 1 and 0.
    truth, scenes = [*"aaaaaabb"], [1, 1, 1, 2, 3, 3, 4, 5]
    predicted = [*"aaabab" + "ba"]
    sizes, right = {"a": [3, 1, 2], "b": [1, 1]}, {"a": [3, 0, 1], "b": [1, 0]}
    recalls = {
        name: [
            sum(right[name][i] for i in some) / sum(sizes[name][i] for i in some)
            for some in product(range(len(sizes[name])), repeat=len(sizes[name]))
        ]
        for name in "ab"
    }
    every = [50 * (a + b) for a, b in product(recalls["a"], recalls["b"])]
    drawn = GroupBootstrap(truth, scenes, draws=DRAWS).accuracies(predicted)
    assert drawn.mean() == pytest.approx(np.mean(every), abs=0.5)
    assert drawn.std() == pytest.approx(np.std(every), abs=0.5)
    assert set(np.round(drawn, 6)) == set(np.round(every, 6))


def test_two_methods_are_compared_on_the_same_draws():
    # One is right wherever the other is, and once more, in every scene: 1 of 2 against 2 of 2.
    truth, scenes = [*"aaaabbbb"], np.repeat([1, 2, 3, 4], 2)
    drawn = GroupBootstrap(truth, scenes, draws=1000)
    assert drawn.difference([*"aaaabbbb"], [*"abababab"]) == (50.0, 50.0)
    # Right in scene 1 where the other is in scene 2: a difference of -50, 0 or 50 points.
    low, high = drawn.difference([*"aabbbbbb"], [*"bbaabbbb"])
    assert (low, high) == (-50.0, 50.0)
    assert drawn.difference([*"aabbbbbb"], [*"aabbbbbb"]) == (0.0, 0.0)


def test_the_same_seed_draws_the_same():
    truth, scenes, predicted = [*"aaabbb"], [1, 2, 3, 4, 5, 6], [*"abaabb"]
    first, second = (GroupBootstrap(truth, scenes, draws=50, seed=3) for _ in range(2))
    np.testing.assert_array_equal(first.accuracies(predicted), second.accuracies(predicted))
    other = GroupBootstrap(truth, scenes, draws=50, seed=4)
    assert (other.accuracies(predicted) != first.accuracies(predicted)).any()
