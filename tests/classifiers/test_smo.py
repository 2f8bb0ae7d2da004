"""The solver of a search finds the machines of LIBSVM, for every cost on its way."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.svm import SVC

from placecue_classifiers.machines import one_against_one, one_against_one_at
from placecue_classifiers.smo import Runs, block, path


def problem(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two classes that overlap: an RBF matrix, signs and weights."""
    generator = np.random.default_rng(seed)
    signs = np.where(generator.random(n) < 0.3, 1.0, -1.0)
    signs[:2] = 1, -1
    features = generator.normal(size=(n, 4)) + 0.7 * signs[:, None]
    gram = np.exp(-0.2 * ((features[:, None] - features[None]) ** 2).sum(axis=2))
    return gram, signs, generator.uniform(0.5, 2, n)


@pytest.mark.parametrize("n", [40, 120])
def test_machines_are_those_of_libsvm(n: int) -> None:
    gram, signs, weights = problem(n, n)
    costs = np.array([0.1, 1.0, 10.0, 100.0])
    found = path(gram, signs, weights, costs, 100_000)
    assert found.finished.all()
    for k, cost in enumerate(costs):
        peer = SVC(kernel="precomputed", C=cost, tol=1e-6).fit(gram, signs, weights)
        outputs = gram @ found.coefficients[k] + found.intercepts[k]
        # The conditions of the optimum hold to within 1e-3.
        assert outputs == pytest.approx(peer.decision_function(gram), abs=5e-3)


@pytest.mark.parametrize("runs", [Runs(0, 30, 50), Runs(7, 50, 0), Runs(20, 1, 40)])
def test_two_runs_of_a_larger_matrix_are_as_good_as_a_copy(runs: Runs) -> None:
    gram, signs, weights = problem(120, 6)
    second = min(50, 120 - runs.second) if runs.second else 0
    rows = np.r_[runs.first : runs.first + runs.length, runs.second : runs.second + second]
    signs = signs[rows]
    signs[:2] = 1, -1
    costs = np.array([0.1, 10.0])
    apart = path(gram, signs, weights[rows], costs, 100_000, runs)
    copied = path(gram[np.ix_(rows, rows)], signs, weights[rows], costs, 100_000)
    np.testing.assert_array_equal(apart.coefficients, copied.coefficients)
    np.testing.assert_array_equal(apart.intercepts, copied.intercepts)


def test_coefficients_keep_to_their_constraints() -> None:
    gram, signs, weights = problem(120, 1)
    costs = np.array([1.0, 100.0])
    found = path(gram, signs, weights, costs, 100_000)
    for k, cost in enumerate(costs):
        alpha = found.coefficients[k] * signs
        assert (alpha >= 0).all()
        assert (alpha <= cost * weights).all()
        assert found.coefficients[k].sum() == pytest.approx(0, abs=1e-9 * cost)


def test_what_takes_long_is_left_unfinished_with_all_that_comes_after() -> None:
    gram, signs, weights = problem(120, 2)
    costs = np.array([0.01, 100.0, 1000.0])
    few = int(path(gram, signs, weights, costs[:1], 10_000).iterations[0]) + 1
    found = path(gram, signs, weights, costs, few)
    assert found.finished.tolist() == [True, False, False]


def test_what_is_left_unfinished_is_trained_by_libsvm(monkeypatch: pytest.MonkeyPatch) -> None:
    generator = np.random.default_rng(3)
    codes = np.arange(80) % 4
    features = generator.normal(size=(80, 3)) + codes[:, None]
    gram = features @ features.T
    monkeypatch.setattr("placecue_classifiers.machines.SOON", 0)
    for C, machines in zip(
        (5.0, 0.5), one_against_one_at(gram, codes, (5.0, 0.5), "balanced"), strict=True
    ):
        expected = one_against_one(gram, codes, C, "balanced")
        assert (machines.coefficients == expected.coefficients).all()
        assert (machines.intercepts == expected.intercepts).all()


def test_costs_come_back_in_their_order() -> None:
    generator = np.random.default_rng(4)
    codes = np.arange(80) % 4
    features = generator.normal(size=(80, 3)) + codes[:, None]
    gram = features @ features.T
    costs = (10.0, 0.1, 1.0)
    for C, machines in zip(costs, one_against_one_at(gram, codes, costs, None), strict=True):
        expected = one_against_one(gram, codes, C, None)
        assert machines.decide(gram) == pytest.approx(expected.decide(gram), abs=0.02)


def test_a_block_is_numpy_s() -> None:
    gram = np.random.default_rng(5).normal(size=(9, 7))
    rows, columns = np.array([8, 0, 3]), np.array([6, 6, 1, 2])
    assert (block(gram, rows, columns) == gram[np.ix_(rows, columns)]).all()
