"""AdaBoost agrees with scikit-learn's on two classes, and its list with METHODS section 4."""

import json
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.ensemble import AdaBoostClassifier
from sklearn.metrics import balanced_accuracy_score
from sklearn.utils.validation import check_is_fitted

from placecue import DataError, Probabilities, Scores, UsageError
from placecue.components.build import build, describe
from placecue.components.manager import load_plugins
from placecue.scores import DecisionList
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.stumps import SortedFeatures

Blobs = tuple[np.ndarray, np.ndarray]
CLASSES = ("corridor", "kitchen", "office", "printer")
REGISTRY = load_plugins(built_ins_only=True).registry
NAMES5 = ("corridor", "kitchen", "lab", "office", "printer")


class Exhaustive(ClassifierMixin, BaseEstimator):
    """The stump of least weighted error, by trying each in turn."""

    def fit(self, X, y, sample_weight=None):  # type: ignore[no-untyped-def]
        self.classes_ = np.unique(y)
        signs = np.where(y == self.classes_[1], 1, -1)
        best = 0.5
        for feature in range(X.shape[1]):
            values = np.unique(X[:, feature])
            middles = [low + (high - low) / 2 for low, high in pairwise(values)]
            for threshold in [-np.inf, *middles]:
                for left in (1, -1):
                    said = np.where(X[:, feature] <= threshold, left, -left)
                    error = sample_weight[said != signs].sum()
                    if error < best - 1e-12:
                        best, self.stump_ = error, (feature, threshold, left)
        return self

    def predict(self, X):  # type: ignore[no-untyped-def]
        check_is_fitted(self)
        feature, threshold, left = self.stump_
        said = np.where(X[:, feature] <= threshold, left, -left)
        return np.where(said > 0, self.classes_[1], self.classes_[0])


def two_classes(labels: np.ndarray) -> np.ndarray:
    return np.where(np.isin(labels, ["corridor", "lab"]), "inside", "outside")


def balanced(labels: np.ndarray) -> np.ndarray:
    _, codes, counts = np.unique(labels, return_inverse=True, return_counts=True)
    return 0.5 / counts[codes]


def test_two_classes_equal_scikit_learn_on_stumps_of_least_error(seen: Blobs) -> None:
    features, labels = seen[0][::2], two_classes(seen[1][::2])
    mine = AdaBoost(rounds=15).fit(features, labels)
    peer = AdaBoostClassifier(Exhaustive(), n_estimators=15)
    peer.fit(features, labels, sample_weight=balanced(labels))
    chosen = [each.stump_[0] for each in peer.estimators_]
    assert mine.features_[1].tolist() == chosen
    assert 2 * mine.alphas_[1] == pytest.approx(peer.estimator_weights_)
    # scikit-learn's counts each stump for one class and against the other: twice as much.
    expected = peer.decision_function(features) / 2
    assert mine.scores(features).values[:, 1] == pytest.approx(expected, abs=1e-9)
    assert mine.scores(features).values[:, 0] == pytest.approx(-expected, abs=1e-9)
    assert (mine.predict(features) == peer.predict(features)).all()


def test_two_classes_equal_scikit_learn_on_its_own_stumps(seen: Blobs, unseen: Blobs) -> None:
    features, labels = seen[0], two_classes(seen[1])
    mine = AdaBoost(rounds=60, criterion="gini").fit(features, labels)
    peer = AdaBoostClassifier(n_estimators=60, random_state=0)
    peer.fit(features, labels, sample_weight=balanced(labels))
    trees = [each.tree_ for each in peer.estimators_]
    assert mine.features_[1].tolist() == [tree.feature[0] for tree in trees]
    assert mine.thresholds_[1] == pytest.approx([tree.threshold[0] for tree in trees], abs=1e-6)
    expected = peer.decision_function(unseen[0]) / 2
    assert mine.scores(unseen[0]).values[:, 1] == pytest.approx(expected, abs=1e-9)


@settings(deadline=None, max_examples=60)
@given(
    values=st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=2, max_size=12),
    seed=st.integers(0, 1000),
)
def test_a_stump_has_the_least_error_of_all(values: list[tuple[int, int]], seed: int) -> None:
    generator = np.random.default_rng(seed)
    features = np.array(values, dtype=np.float64)
    signs = generator.choice([-1.0, 1.0], len(features))
    weights = generator.dirichlet(np.ones(len(features)))
    stump = SortedFeatures.of(features).best(signs, weights)
    least = min(
        weights[np.where(features[:, column] <= threshold, left, -left) != signs].sum()
        for column in range(2)
        for threshold in [-1, 0.5, 1.5, 2.5, 3.5]
        for left in (1, -1)
    )
    assert weights[stump(features) != signs].sum() == pytest.approx(least, abs=1e-9)


def test_outputs_of_all_classes_and_the_order_of_the_list(seen: Blobs, unseen: Blobs) -> None:
    features, labels = seen
    boosted = AdaBoost(rounds=20).fit(features, labels)
    values = boosted.scores(features).values
    assert values.shape == (len(labels), 5)
    assert np.abs(values).max() <= 1 + 1e-12
    wrong = [((values[:, k] > 0) != (labels == name)).mean() for k, name in enumerate(NAMES5)]
    assert boosted.errors_ == pytest.approx(wrong)
    assert boosted.order_ == np.argsort(wrong, kind="stable").tolist()
    # The rule, spelt out: the first of the list that accepts, else the last.
    unseen_values = boosted.scores(unseen[0]).values
    expected = []
    for row in unseen_values:
        accepting = [code for code in boosted.order_[:-1] if row[code] > 0]
        expected.append(NAMES5[(accepting or boosted.order_[-1:])[0]])
    assert boosted.predict(unseen[0]).tolist() == expected
    assert balanced_accuracy_score(unseen[1], expected) > 0.5


def test_the_probabilistic_list(seen: Blobs) -> None:
    features, labels = seen
    listed = AdaBoost(rounds=12).fit(features, labels)
    probable = AdaBoost(rounds=12, output="probability").fit(features, labels)
    assert isinstance(probable.layout_, Probabilities)
    totals = listed.scores(features).values * listed.alphas_.sum(axis=1)
    found = probable.scores(features).values
    assert found.sum(axis=1) == pytest.approx(1)
    for row in range(0, len(labels), 17):
        left = 1.0
        for place, code in enumerate(listed.order_):
            accept = 1 / (1 + np.exp(-2 * totals[row, code])) if place < 4 else 1.0
            assert found[row, code] == pytest.approx(left * accept)
            left *= 1 - accept


def test_weights_are_those_of_the_group() -> None:
    # One feature, six samples; the best stump, x <= 2.5, is wrong about one: r = 1 - 2 e.
    features = np.array([[1.0], [2.0], [3.0], [4.0], [5.0], [6.0]])
    labels = np.array(["b", "b", "a", "a", "b", "a"])
    boosted = AdaBoost(rounds=1, class_weight=None).fit(features, labels)
    r = 1 - 2 * (1 / 6)
    assert boosted.thresholds_.tolist() == [[2.5], [2.5]]
    assert boosted.alphas_[0, 0] == pytest.approx(0.5 * np.log((1 + r) / (1 - r)))


def test_class_weights_move_the_decision(seen: Blobs, unseen: Blobs) -> None:
    labels = two_classes(seen[1])
    heavy = AdaBoost(rounds=3, class_weight={"inside": 50}).fit(seen[0], labels)
    light = AdaBoost(rounds=3, class_weight={"inside": 0.02}).fit(seen[0], labels)
    share = [(each.predict(unseen[0]) == "inside").mean() for each in (heavy, light)]
    assert share[0] > 0.7 > 0.3 > share[1]


def test_a_perfect_stump_ends_the_rounds() -> None:
    features = np.arange(8.0)[:, None]
    labels = np.repeat(CLASSES, 2)
    boosted = AdaBoost().fit(features, labels)
    assert (boosted.alphas_[0] > 0).sum() == 1
    assert boosted.predict(features[:2]).tolist() == ["corridor", "corridor"]


def test_features_that_say_nothing_leave_nothing_accepted() -> None:
    boosted = AdaBoost().fit(np.ones((8, 3)), np.repeat(CLASSES, 2))
    assert boosted.scores(np.ones((2, 3))).values.tolist() == [[0.0] * 4] * 2


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"rounds": 0}, "rounds must be 1 or more"),
        ({"output": "probabilities"}, "did you mean 'probability'"),
        ({"criterion": "entropy"}, "available: error, gini"),
        ({"class_weight": "equal"}, "class_weight"),
    ],
)
def test_wrong_parameters_are_named(seen: Blobs, parameters: dict, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        AdaBoost(**parameters).fit(*seen)


def test_wrong_features_are_named(seen: Blobs) -> None:
    from scipy import sparse

    from placecue import DescriptorSets

    features, labels = seen
    with pytest.raises(UsageError, match="takes dense vectors, got sparse histogram"):
        AdaBoost().fit(sparse.csr_array(features), labels)
    sets = DescriptorSets(np.ones((175, 2)), np.arange(176))
    with pytest.raises(UsageError, match="takes dense vectors, got set of local"):
        AdaBoost().fit(sets, labels)
    spoilt = features.copy()
    spoilt[3, 1] = np.inf
    with pytest.raises(DataError, match="1 of 175 samples hold NaN or infinite"):
        AdaBoost().fit(spoilt, labels)
    with pytest.raises(DataError, match="of one class only"):
        AdaBoost().fit(features, np.repeat("lab", 175))


# ---------------------------------------------------------------------- the layout


def test_a_list_takes_the_first_that_accepts() -> None:
    layout = DecisionList(CLASSES, ("office", "corridor", "printer", "kitchen"))
    values = np.array(
        [
            [0.9, 0.8, -0.2, 0.7],  # office refuses by 0.2, corridor accepts by 0.9
            [-0.5, -0.9, -0.2, -0.3],  # none accepts: the last, kitchen
            [-0.4, 0.9, 0.1, 0.8],  # office accepts, by 0.1
        ]
    )
    decision = Scores(values, layout).decide()
    assert decision.labels.tolist() == ["corridor", "kitchen", "office"]
    assert decision.confidence == pytest.approx([0.2, 0.2, 0.1])
    # After the winner: the others that accept, in order; the last class; the rest by output.
    assert decision.ranking.tolist() == [[0, 3, 1, 2], [1, 2, 3, 0], [2, 3, 1, 0]]


def test_a_list_survives_json_and_must_be_whole() -> None:
    layout = DecisionList(CLASSES, ("office", "corridor", "printer", "kitchen"))
    assert build(json.loads(json.dumps(describe(layout, REGISTRY))), "layout", REGISTRY) == layout
    with pytest.raises(UsageError, match="names each of its classes"):
        DecisionList(CLASSES, ("office", "corridor", "printer"))
