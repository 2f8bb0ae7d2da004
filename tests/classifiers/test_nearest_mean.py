"""Nearest class mean: by the formula, like scikit-learn, and the same however it is taught."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.covariance import oas
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis

from classifiers.conftest import five_blobs
from placecue import DataError, UsageError
from placecue_classifiers.nearest_mean import NearestMean, shrunken

Samples = tuple[np.ndarray, np.ndarray]
SHARED = {"covariance": "shared", "shrinkage": 0.3}


def unit(rows: np.ndarray) -> np.ndarray:
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def test_scores_are_those_of_the_distance_to_each_mean(seen: Samples, unseen: Samples) -> None:
    found = NearestMean().fit(*seen).scores(unseen[0])
    names = np.unique(seen[1])
    means = np.stack([unit(seen[0])[seen[1] == name].mean(axis=0) for name in names])
    squared = ((unit(unseen[0])[:, None] - means) ** 2).sum(axis=2)
    assert found.layout.classes == tuple(names)
    # A squared distance is 1 less twice the dot product plus the squared length of the mean.
    np.testing.assert_allclose(found.values, 1 - squared, atol=1e-5)
    assert (found.decide().labels == names[squared.argmin(axis=1)]).mean() > 0.999


def test_a_shared_covariance_is_linear_discriminant_analysis(
    seen: Samples, unseen: Samples
) -> None:
    found = NearestMean(**SHARED).fit(*seen).scores(unseen[0])
    other = LinearDiscriminantAnalysis(solver="lsqr", shrinkage=0.3).fit(unit(seen[0]), seen[1])
    # scikit-learn adds the logarithms of the classes' shares, and we have all classes alike.
    wanted = other.decision_function(unit(unseen[0])) - np.log(other.priors_)
    np.testing.assert_allclose(found.values, wanted, rtol=1e-3, atol=1e-3)


def test_the_shrinkage_is_that_of_the_paper() -> None:
    # scikit-learn leaves out a term that is of no account where there are many features.
    rows = np.random.default_rng(0).normal(size=(60, 400)) * np.linspace(0.2, 3, 400)
    wanted, share = oas(rows, assume_centered=True)
    assert 0.1 < share < 0.95
    np.testing.assert_allclose(shrunken(rows.T @ rows / 60, 60, "oas"), wanted, atol=0.01)
    assert shrunken(np.diag([1.0, 3]), 5, 0.5).tolist() == [[1.5, 0], [0, 2.5]]


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), shared=st.booleans())
def test_it_is_the_same_in_any_order_and_however_it_is_cut(seed: int, shared: bool) -> None:
    features, labels = five_blobs(0)
    options = SHARED if shared else {}
    whole = NearestMean(**options).fit(features, labels)
    generator = np.random.default_rng(seed)
    order = generator.permutation(len(labels))
    cuts = np.sort(generator.choice(np.arange(1, len(labels)), generator.integers(0, 40)))
    parts = NearestMean(**options)
    for rows in np.split(order, np.unique(cuts)):
        parts.partial_fit(features[rows], labels[rows])
    asked = five_blobs(1)[0]
    assert parts.scores(asked).values.tobytes() == whole.scores(asked).values.tobytes()


def test_a_new_class_comes_in_and_the_old_ones_stay(seen: Samples) -> None:
    features, labels = seen
    known = labels != "lab"
    classifier = NearestMean().fit(features[known], labels[known])
    before = classifier.means_
    classifier.partial_fit(features[~known], labels[~known])
    assert classifier.classes_.tolist() == ["corridor", "kitchen", "lab", "office", "printer"]
    np.testing.assert_array_equal(classifier.means_[[0, 1, 3, 4]], before)
    assert classifier.predict(classifier.means_).tolist() == classifier.classes_.tolist()


def test_one_label_a_class_is_enough_to_begin_with(seen: Samples, unseen: Samples) -> None:
    rows = [np.flatnonzero(seen[1] == name)[0] for name in np.unique(seen[1])]
    for options in ({}, {"covariance": "shared"}):
        found = NearestMean(**options).fit(seen[0][rows], seen[1][rows])
        assert (found.predict(seen[0][rows]) == seen[1][rows]).all()
        assert np.isfinite(found.scores(unseen[0]).values).all()


def test_what_cannot_be_is_refused(seen: Samples) -> None:
    features, labels = seen
    classifier = NearestMean().fit(features, labels)
    with pytest.raises(DataError, match="X has 3 features, but NearestMean is expecting 6"):
        classifier.partial_fit(features[:2, :3], labels[:2])
    with pytest.raises(DataError, match="NaN"):
        classifier.partial_fit(np.full((1, 6), np.nan), labels[:1])
    with pytest.raises(DataError, match="'attic', which is none of the classes"):
        classifier.partial_fit(features[:1], ["attic"], classes=["office", "lab"])
    with pytest.raises(UsageError, match="covariance is 'own'"):
        NearestMean("own").fit(features, labels)
    for wrong in ("much", 1.5):
        with pytest.raises(UsageError, match="shrinkage is"):
            NearestMean(shrinkage=wrong).fit(features, labels)
