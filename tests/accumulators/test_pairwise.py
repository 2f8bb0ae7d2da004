"""Fields over graphs against the sum over all labellings."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from placecue import DataError
from placecue_accumulators.neighbours import Neighbours, learned_field
from placecue_accumulators.pairwise import belief_propagation, relaxed


def field(seed, n, classes):
    rng = np.random.default_rng(seed)
    pair = rng.normal(0, 1, (classes, classes))
    return rng.normal(0, 1, (n, classes)), pair + pair.T


def by_all_labellings(unary, pair, edges):
    n, m = unary.shape
    shares = np.zeros((n, m))
    for labels in product(range(m), repeat=n):
        logarithm = sum(unary[i, c] for i, c in enumerate(labels))
        logarithm += sum(pair[labels[a], labels[b]] for a, b in edges)
        shares[range(n), labels] += np.exp(logarithm)
    return shares / shares.sum(axis=1, keepdims=True)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 9999), st.integers(1, 6), st.integers(2, 3))
def test_exact_on_trees(seed, n, classes):
    unary, pair = field(seed, n, classes)
    edges = [(int(np.random.default_rng(seed + i).integers(i)), i) for i in range(1, n)]
    found = belief_propagation(unary, pair, edges)
    np.testing.assert_allclose(found, by_all_labellings(unary, pair, edges), atol=1e-6)


def test_close_on_a_loop():
    rng = np.random.default_rng(3)
    unary, pair = rng.normal(0, 1, (5, 3)), 0.8 * np.eye(3)
    edges = [(0, 1), (1, 2), (2, 3), (3, 4), (0, 4)]
    found = belief_propagation(unary, pair, edges)
    np.testing.assert_allclose(found, by_all_labellings(unary, pair, edges), atol=0.03)


def test_nodes_in_two_parts_do_not_touch():
    unary, pair = field(1, 4, 3)
    found = belief_propagation(unary, pair, [(0, 1), (2, 3)])
    alone = belief_propagation(unary[:2], pair, [(0, 1)])
    np.testing.assert_allclose(found[:2], alone, atol=1e-9)


def test_without_edges_what_was_seen_decides():
    unary, pair = field(2, 3, 4)
    expected = np.exp(unary) / np.exp(unary).sum(axis=1, keepdims=True)
    np.testing.assert_allclose(belief_propagation(unary, pair, []), expected)
    np.testing.assert_allclose(relaxed(expected, pair, []), expected)


def test_one_round_of_relaxation_by_hand():
    start = np.array([[0.6, 0.4], [0.2, 0.8]])
    compatibility = np.array([[0.5, -0.5], [-0.5, 0.5]])
    # To node 0 its neighbour says 0.2 * 0.5 - 0.8 * 0.5 = -0.3 and 0.3:
    # 0.6 * 0.7 = 0.42, 0.4 * 1.3 = 0.52. To node 1: 0.1 and -0.1: 0.22 and 0.72.
    expected = [[0.42 / 0.94, 0.52 / 0.94], [0.22 / 0.94, 0.72 / 0.94]]
    np.testing.assert_allclose(relaxed(start, compatibility, [(0, 1)], rounds=1), expected)


def test_learned_weights_have_neighbours_alike_and_beat_what_was_seen_alone():
    rng = np.random.default_rng(0)
    truth = np.repeat([0, 1, 0, 2, 0, 1, 2, 0], 12)
    edges = [(i, i + 1) for i in range(len(truth) - 1)]
    unary = rng.normal(0, 1, (len(truth), 3))
    unary[np.arange(len(truth)), truth] += 1.0
    found = learned_field(unary, edges, truth, ("a", "b", "c"))
    np.testing.assert_allclose(found.weights, found.weights.T)
    assert (
        np.diag(found.weights) > found.weights.max(axis=1, where=~np.eye(3, dtype=bool), initial=-9)
    ).all()
    joint = belief_propagation(found.seen * unary, found.weights, edges).argmax(axis=1)
    assert (joint == truth).mean() > (unary.argmax(axis=1) == truth).mean() + 0.1


def test_the_slope_of_the_learning_is_right():
    """At the optimum no weight can be moved a little for the better."""
    rng = np.random.default_rng(1)
    truth = rng.integers(0, 3, 20)
    unary, edges = rng.normal(0, 1, (20, 3)), [(i, i + 1) for i in range(19)]
    found = learned_field(unary, edges, truth, ("a", "b", "c"), prior=0.5)

    def loss(seen, free):
        total = 0.0
        for i in range(20):
            around = [truth[b if a == i else a] for a, b in edges if i in (a, b)]
            odds = seen * unary[i] + sum((free + free.T)[c] for c in around)
            total -= odds[truth[i]] - np.log(np.exp(odds).sum())
        return total + 0.5 * (seen**2 + (free**2).sum())

    free = found.weights / 2  # the smallest squares of all that add up to it
    best = loss(found.seen, free)
    for i, j in product(range(3), repeat=2):
        for step in (-0.01, 0.01):
            moved = free.copy()
            moved[i, j] += step
            assert loss(found.seen, moved) > best
    assert min(loss(found.seen + 0.01, free), loss(found.seen - 0.01, free)) > best


def test_weights_survive_a_file_in_any_order_of_classes(tmp_path):
    weights = np.arange(9.0).reshape(3, 3)
    Neighbours(("a", "b", "c"), weights, 0.7).write(tmp_path / "w.json")
    found = Neighbours.read(tmp_path / "w.json", ("c", "a"))
    np.testing.assert_array_equal(found.weights, [[8, 6], [2, 0]])
    assert found.seen == 0.7
    with pytest.raises(DataError, match=r"no weights of lift; it has \['a', 'b', 'c'\]"):
        Neighbours.read(tmp_path / "w.json", ("a", "lift"))


@pytest.mark.parametrize("content", ["{}", "[]", "x", '{"classes": ["a"], "weights": [[1, 2]]}'])
def test_other_files_are_refused(tmp_path, content):
    (tmp_path / "w.json").write_text(content)
    with pytest.raises(DataError, match="holds no weights of neighbours"):
        Neighbours.read(tmp_path / "w.json", ("a",))
