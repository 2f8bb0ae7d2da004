"""Gradient-boosted decision trees that a model folder can hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Self

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from sklearn.ensemble import HistGradientBoostingClassifier
from threadpoolctl import threadpool_limits

from placecue.checks import check_number, check_whole
from placecue.classifier import Classifier, wrong_kind
from placecue.features import FeatureBatch, FeatureKind, kind_of
from placecue.scores import Probabilities, Scores
from placecue_classifiers.weights import ClassWeight, check_class_weight, of_classes

#: Fewest numbers in the training samples for more than one thread.
_WORTH_THREADS = 1_000_000


class BoostedTrees(Classifier):
    """Gradient boosting of decision trees on dense vectors, multinomial deviance.

    scikit-learn grows the trees on histograms of the features; what is kept of them is plain
    arrays, so that a model is small, holds no training sample and answers fast. Scores are
    probabilities. Features need no scaling, and a tree may ask for two of them together, which
    the stumps of AdaBoost cannot.

    Parameters
    ----------
    rounds : int
        Number of trees a class.
    learning_rate : float
        What each tree is shrunk by.
    leaves : int
        Most leaves of a tree.
    leaf_samples : int
        Fewest samples in a leaf.
    l2 : float
        Penalty on the values of leaves.
    class_weight : {"balanced"}, mapping of class to weight, or None
        Every class weighs the same, or as much as is given (1 where nothing is), or every sample.
    random_state : int
        For the sample that the bins of the histograms are found on.

    Attributes
    ----------
    layout_ : Probabilities
        What the columns of the scores are.
    trees_ : ndarray of int32, shape (T, K)
        Node where tree t of column k begins; K is 1 where there are two classes, else their
        number.
    features_ : ndarray of int16, shape (N,)
        The feature that each node asks for; -1 in a leaf.
    thresholds_ : ndarray of float32, shape (N,)
        A sample goes left up to it.
    left_, right_ : ndarray of int32, shape (N,)
        The nodes that follow.
    values_ : ndarray of float32, shape (N,)
        What a leaf adds.
    baseline_ : ndarray of float64, shape (K,)
        What the sums begin with.
    width_ : int
        Number of features.

    References
    ----------
    Friedman, Greedy function approximation: a gradient boosting machine, Annals of Statistics
    29(5), 2001.
    """

    def __init__(
        self,
        rounds: int = 100,
        learning_rate: float = 0.1,
        leaves: int = 16,
        leaf_samples: int = 20,
        l2: float = 1.0,
        class_weight: ClassWeight = "balanced",
        random_state: int = 0,
    ) -> None:
        self.rounds = rounds
        self.learning_rate = learning_rate
        self.leaves = leaves
        self.leaf_samples = leaf_samples
        self.l2 = l2
        self.class_weight = class_weight
        self.random_state = random_state

    def check_parameters(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        check_whole("rounds", self.rounds, least=1)
        check_whole("leaves", self.leaves, least=2)
        check_whole("leaf_samples", self.leaf_samples, least=1)
        check_number("learning_rate", self.learning_rate, above=0)
        check_number("l2", self.l2, least=0)
        check_class_weight(self.class_weight)

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Train on n samples; see :meth:`placecue.classifier.Classifier.fit`.

        Raises
        ------
        UsageError
            If a parameter cannot be, or the features are not dense vectors.
        DataError
            If there is one class only, or a feature is NaN or infinite.
        """
        self.check_parameters()
        dense = _dense(self.training_samples(self._only_dense(features), labels))
        codes = self.learn_classes(labels)
        by_name = of_classes(self.class_weight, self.class_names)
        weights = None if by_name is None else by_name[codes]
        # On few samples threads wait for one another longer than they work.
        threads = 1 if dense.size < _WORTH_THREADS else None
        with threadpool_limits(threads, "openmp"):
            grown = self._grown().fit(dense, codes, sample_weight=weights)
        self._keep(grown)
        self.width_ = int(dense.shape[1])
        self.layout_ = Probabilities(self.class_names)
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return the probabilities of n samples, shape (n, M)."""
        dense = _dense(self.samples(self._only_dense(features)))
        nodes = self.features_, self.thresholds_, self.left_, self.right_, self.values_
        raw = self.baseline_ + _sums(dense, self.trees_, *nodes)
        if raw.shape[1] == 1:
            raw = np.hstack([np.zeros_like(raw), raw])
        powers = np.exp(raw - raw.max(axis=1, keepdims=True))
        return Scores(powers / powers.sum(axis=1, keepdims=True), self.layout_)

    def check_learned(self) -> None:
        """Check what a model folder says: every path ends in a leaf.

        Raises
        ------
        ValueError
            If the arrays do not fit together.
        """
        n, columns = len(self.features_), 1 if len(self.labels_) == 2 else len(self.labels_)
        for name in ("thresholds_", "left_", "right_", "values_"):
            if getattr(self, name).shape != (n,):
                raise ValueError(f"{name} is not of {n} nodes")
        if self.trees_.ndim != 2 or self.trees_.shape[1] != columns:
            raise ValueError(f"trees_ is not of {columns} columns")
        if self.baseline_.shape != (columns,):
            raise ValueError(f"baseline_ is not of {columns} columns")
        asks = np.flatnonzero(self.features_ >= 0)
        if n and int(self.features_.max()) >= self.width_:
            raise ValueError(f"a node asks for a feature beyond the {self.width_} there are")
        for following in (self.left_[asks], self.right_[asks]):
            # Forwards only, so that nothing goes round in circles.
            if (following <= asks).any() or (following >= n).any():
                raise ValueError("a node is followed by one before it, or by none")
        if (self.trees_ < 0).any() or (self.trees_ >= n).any():
            raise ValueError("a tree begins at no node")

    def _grown(self) -> HistGradientBoostingClassifier:
        return HistGradientBoostingClassifier(
            max_iter=self.rounds,
            learning_rate=self.learning_rate,
            max_leaf_nodes=self.leaves,
            min_samples_leaf=self.leaf_samples,
            l2_regularization=self.l2,
            class_weight=None if isinstance(self.class_weight, Mapping) else self.class_weight,
            early_stopping=False,
            random_state=self.random_state,
        )

    def _keep(self, grown: HistGradientBoostingClassifier) -> None:
        """Keep the trees as arrays; scikit-learn has no public way to them."""
        trees = [[tree.nodes for tree in of_round] for of_round in grown._predictors]
        sizes = np.array([[len(nodes) for nodes in of_round] for of_round in trees])
        starts = np.cumsum(sizes.ravel()) - sizes.ravel()
        self.trees_ = starts.reshape(sizes.shape).astype(np.int32)
        nodes = np.concatenate([nodes for of_round in trees for nodes in of_round])
        first = np.repeat(starts, sizes.ravel())
        leaf = nodes["is_leaf"].astype(bool)
        self.features_ = np.where(leaf, -1, nodes["feature_idx"]).astype(np.int16)
        self.thresholds_ = np.where(leaf, 0, nodes["num_threshold"]).astype(np.float32)
        self.left_ = np.where(leaf, 0, nodes["left"] + first).astype(np.int32)
        self.right_ = np.where(leaf, 0, nodes["right"] + first).astype(np.int32)
        self.values_ = np.where(leaf, nodes["value"], 0).astype(np.float32)
        self.baseline_ = np.asarray(grown._baseline_prediction, dtype=np.float64).reshape(-1)

    def _only_dense(self, features: FeatureBatch) -> FeatureBatch:
        if kind_of(features) is not FeatureKind.DENSE:
            raise wrong_kind(self, "dense vectors", features)
        return features


def _dense(features: FeatureBatch) -> NDArray[np.float32]:
    # Beyond single precision is as far as a threshold can tell.
    most = float(np.finfo(np.float32).max)
    return np.clip(np.asarray(features, dtype=np.float64), -most, most).astype(np.float32)


@njit(cache=True, nogil=True)
def _sums(samples, trees, features, thresholds, left, right, values):  # type: ignore[no-untyped-def]
    """Return the sum over the trees of each column, shape (n, K)."""
    rounds, columns = trees.shape
    sums = np.zeros((len(samples), columns))
    for row in range(len(samples)):
        for t in range(rounds):
            for column in range(columns):
                node = trees[t, column]
                while features[node] >= 0:
                    below = samples[row, features[node]] <= thresholds[node]
                    node = left[node] if below else right[node]
                sums[row, column] += values[node]
    return sums
