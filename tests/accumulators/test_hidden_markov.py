"""The hidden Markov model against the sum, and the maximum, over all sequences."""

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from placecue_accumulators.hidden_markov import forward, smoothed, staying, viterbi
from placecue_accumulators.neighbours import steps_between


def problem(seed, steps, classes):
    rng = np.random.default_rng(seed)
    seen = rng.normal(0, 2, (steps, classes))
    moves = np.log(rng.dirichlet(np.ones(classes), classes))
    weight = {
        path: sum(seen[t, c] for t, c in enumerate(path))
        + sum(moves[a, b] for a, b in pairwise(path))
        for path in product(range(classes), repeat=steps)
    }
    return seen, moves, weight


def marginals(weight, steps, classes):
    """Return the probability of each class at each step, over all sequences."""
    shares = np.zeros((steps, classes))
    for path, logarithm in weight.items():
        for t, c in enumerate(path):
            shares[t, c] += np.exp(logarithm)
    return shares / shares.sum(axis=1, keepdims=True)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 9999), st.integers(1, 5), st.integers(2, 4))
def test_against_all_sequences(seed, steps, classes):
    seen, moves, weight = problem(seed, steps, classes)
    assert tuple(viterbi(seen, moves)) == max(weight, key=weight.get)
    expected = marginals(weight, steps, classes)
    np.testing.assert_allclose(smoothed(seen, moves), expected, atol=1e-9)
    np.testing.assert_allclose(np.exp(forward(seen, moves)[-1]), expected[-1], atol=1e-9)


def test_a_place_lasts_as_long_as_said():
    moves = np.exp(staying(4, step=1.0, lasts=5.0))
    np.testing.assert_allclose(moves.sum(axis=1), 1)
    # Left with 1 - exp(-1 / 5) = 0.1813 a step, for each of the three others alike.
    assert moves[0, 1] == pytest.approx(0.18127 / 3, rel=1e-4)
    assert moves[2, 2] == pytest.approx(0.81873, rel=1e-4)


def test_transitions_are_counted_along_a_drive():
    labels = ["office", "office", "corridor", "lift", "corridor", "office"]
    found = steps_between(labels, ("corridor", "kitchen", "office"), before=1.0)
    # The lift is passed over: of, of, co, co, of.
    np.testing.assert_allclose(found.weights[0], np.array([2, 1, 2]) / 5)
    np.testing.assert_allclose(found.weights[1], np.full(3, 1 / 3))
    np.testing.assert_allclose(found.weights[2], np.array([2, 1, 2]) / 5)
