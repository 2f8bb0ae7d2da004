"""Learned weights of kernels, against worked examples and small programmes solved by scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from placecue import FeatureParts, UsageError
from placecue_kernels.alignment import aligned
from placecue_kernels.easy_mkl import by_margin, nearest_points
from placecue_kernels.linear import Linear
from placecue_kernels.mkl import MKL
from placecue_kernels.rbf import RBF

U, T = np.array([3.0, 1, -1, -3]), np.array([1.0, 2, -1, -2])
PAIR = np.array(["a", "a", "b", "b"])
BOTH = {"u": Linear(), "t": Linear()}
#: Two parts of one column each, and a third that says nothing of the classes.
FOUR = FeatureParts({"u": U[:, None], "t": T[:, None]})


def problem(seed: int, n: int = 14, classes: int = 4) -> tuple[list[np.ndarray], np.ndarray]:
    """Kernels of some vectors that tell classes apart well, a little and not at all."""
    generator = np.random.default_rng(seed)
    codes = np.arange(n) % classes
    places = generator.normal(size=(classes, 3))[codes]
    noises = (0.3, 1.0, 2.0, 30.0)
    vectors = [places + noise * generator.normal(size=places.shape) for noise in noises]
    return [RBF(0.3 / (1 + noise)).gram(x) for noise, x in zip(noises, vectors, strict=True)], codes


def alignment(weights: np.ndarray, grams: list[np.ndarray], codes: np.ndarray) -> float:
    """The centred alignment of a weighted sum with the classes, as its definition says."""
    n = len(codes)
    centre = np.eye(n) - np.ones((n, n)) / n
    joined = centre @ np.tensordot(weights, grams, 1) @ centre
    same = centre @ (codes[:, None] == codes).astype(float) @ centre
    return float((joined * same).sum() / np.linalg.norm(joined) / np.linalg.norm(same))


@pytest.mark.parametrize("seed", range(4))
def test_no_weights_are_better_aligned(seed: int) -> None:
    grams, codes = problem(seed)
    found = aligned(grams, codes)
    best = minimize(
        lambda weights: -alignment(weights, grams, codes),
        np.full(4, 0.25),
        method="SLSQP",
        bounds=[(0, 1)] * 4,
        constraints={"type": "eq", "fun": lambda weights: weights.sum() - 1},
        options={"ftol": 1e-13, "maxiter": 500},
    )
    assert best.success
    np.testing.assert_allclose(found / found.sum(), best.x, atol=2e-4)
    assert alignment(found, grams, codes) >= -best.fun - 1e-9
    assert found[0] > found[3]


def test_alignment_by_hand() -> None:
    """(u.u)^2 = 400, (u.t)^2 = 144, (t.t)^2 = 100; with the classes (u.y)^2 / 2 = 32, and 18.

    The weights v solve 400 v1 + 144 v2 = 32 and 144 v1 + 100 v2 = 18, so that v1 : v2 = 19 : 81.
    The means of the diagonals are 5 and 2.5, and the sum's shall be 1.
    """
    kernel = MKL(BOTH).fit(FOUR, PAIR)
    assert kernel.weights_ == pytest.approx({"u": 19 / 297.5, "t": 81 / 297.5})
    expected = (19 * np.outer(U, U) + 81 * np.outer(T, T)) / 297.5
    np.testing.assert_allclose(kernel.gram(FOUR), expected)
    np.testing.assert_allclose(kernel.gram(FOUR, FOUR[np.array([2])]), expected[:, [2]])
    assert np.diagonal(kernel.gram(FOUR)).mean() == pytest.approx(1)


def test_the_size_of_a_kernel_is_no_matter() -> None:
    twice = FeatureParts({"u": 1e5 * U[:, None], "t": T[:, None]})
    for method in ("alignment", "easymkl"):
        one, other = (MKL(BOTH, method).fit(each, PAIR) for each in (FOUR, twice))
        np.testing.assert_allclose(one.gram(FOUR), other.gram(twice), rtol=1e-6)


def test_kernels_that_say_the_same_or_nothing() -> None:
    z = np.array([1.0, -1, 1, -1])  # at right angles to the classes
    same = np.outer(U, U)
    codes = np.array([0, 0, 1, 1])
    assert aligned([same, np.outer(z, z)], codes)[1] == 0
    weights = aligned([same, same, np.ones((4, 4))], codes)
    assert weights[2] == 0
    assert weights[:2].sum() == pytest.approx(32 / 400)
    nothing = FeatureParts({"u": z[:, None], "t": np.ones((4, 1))})
    assert MKL(BOTH).fit(nothing, PAIR).weights_ == pytest.approx({"u": 0.5, "t": 0.5})


def test_easymkl_of_means_by_hand() -> None:
    """With full regularization d is the squared distance of the means: 4**2 / 5 and 3**2 / 2.5."""
    weights = MKL(BOTH, "easymkl", 1.0).fit(FOUR, PAIR).weights_
    assert weights == pytest.approx({"u": 3.2 / 6.8 / 5, "t": 3.6 / 6.8 / 2.5})


@pytest.mark.parametrize("regularization", [0.05, 0.4])
def test_easymkl_solves_its_programme(regularization: float) -> None:
    grams, codes = problem(5)
    expected = np.zeros(4)
    for code in range(4):
        sides = np.where(codes == code, 1.0, -1.0)
        positive = sides > 0
        signed = [sides[:, None] * gram * sides for gram in grams]
        total = (1 - regularization) * np.sum(signed, axis=0)
        total += regularization * np.eye(len(codes))
        best = minimize(
            lambda g, total=total: g @ total @ g,
            np.where(positive, 1 / positive.sum(), 1 / (~positive).sum()),
            jac=lambda g, total=total: 2 * total @ g,
            method="SLSQP",
            bounds=[(0, 1)] * len(codes),
            constraints=[
                {"type": "eq", "fun": lambda g, side=side: g[side].sum() - 1}
                for side in (positive, ~positive)
            ],
            options={"ftol": 1e-14, "maxiter": 1000},
        )
        assert best.success
        own = sides[:, None] * total * sides
        np.testing.assert_allclose(nearest_points(own, sides), best.x, atol=1e-4)
        expected += [best.x @ gram @ best.x for gram in signed]
    found = by_margin(grams, codes, regularization)
    np.testing.assert_allclose(found / found.sum(), expected / expected.sum(), atol=1e-4)


def test_it_needs_labels_and_training() -> None:
    with pytest.raises(UsageError, match="mkl learns its weights from the classes of the samples"):
        MKL(BOTH).fit(FOUR)
    with pytest.raises(UsageError, match="mkl learns its weights in training: fit it first"):
        MKL(BOTH).gram(FOUR)
    assert MKL(BOTH).wants_labels
    assert not RBF().wants_labels


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"method": "aligned"}, "kernel.method"),
        ({"regularization": 0.0}, "kernel.regularization is 0.0; give a number above 0"),
        ({"regularization": 1.5}, "kernel.regularization is 1.5; give a number of at most 1"),
    ],
)
def test_wrong_parameters(parameters: dict, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        MKL(BOTH, **parameters).check_parameters()
