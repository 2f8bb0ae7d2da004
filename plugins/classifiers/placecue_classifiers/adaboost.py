"""AdaBoost on single-valued features, joined to several classes by a decision list."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.classifier import Classifier, wrong_kind
from placecue.errors import UsageError, choices
from placecue.features import FeatureBatch, FeatureKind, kind_of
from placecue.progress import track
from placecue.scores import DecisionList, Probabilities, Scores
from placecue_classifiers.stumps import CRITERIA, SortedFeatures, Stump
from placecue_classifiers.weights import ClassWeight, check_class_weight, of_classes

Matrix = NDArray[np.float64]
OUTPUTS = ("confidence", "probability")


class AdaBoost(Classifier):
    """Discrete AdaBoost of decision stumps, one strong classifier a class against the rest.

    The classifiers form a decision list in order of increasing training error (equal ones in
    order of label): a sample belongs to the first class whose classifier accepts it, and to the
    last class if none of the others does.

    Parameters
    ----------
    rounds : int
        Stumps a class; fewer where one is without error, or no better than a guess.
    class_weight : {"balanced"}, mapping of class to weight, or None
        Begin with equal weight of the class and of the rest, with the weights given (1 where
        none is), or with equal weight of all samples.
    output : {"confidence", "probability"}
        ``confidence``: for each class H_j = sum_t alpha_t h_t / sum_t alpha_t in [-1, 1], on
        which the list decides. ``probability``: the probabilistic list P(k) = C_k prod (1 - C_j)
        over the j before k, with C_j = 1 / (1 + exp(-2 sum_t alpha_t h_t)) and 1 for the last.
    criterion : {"error", "gini"}
        What a stump is chosen by: its weighted error, or the Gini impurity as the stumps of
        scikit-learn.

    Attributes
    ----------
    layout_ : DecisionList or Probabilities
        What the columns of the scores are.
    order_ : list of int
        The classes in order of the list, as numbers.
    errors_ : ndarray of float64, shape (M,)
        Share of the training samples on which the classifier of each class is wrong.
    features_ : ndarray of int64, shape (M, T)
        The feature of each stump; T is the largest number of stumps of a class.
    thresholds_ : ndarray of float64, shape (M, T)
        Its threshold.
    left_, right_ : ndarray of int64, shape (M, T)
        What it says (-1 or 1) up to the threshold, and above.
    alphas_ : ndarray of float64, shape (M, T)
        Its weight, ln((1 + r) / (1 - r)) / 2 with r = sum_i w_i y_i h(x_i); 0 where there is none.

    References
    ----------
    Martinez Mozos, Stachniss and Burgard, ICRA 2005; Martinez Mozos et al., RAS 55(5), 2007;
    Friedman, Hastie and Tibshirani, Additive logistic regression, Annals of Statistics 28(2),
    2000 (C_j).
    """

    def __init__(
        self,
        rounds: int = 100,
        class_weight: ClassWeight = "balanced",
        output: str = "confidence",
        criterion: str = "error",
    ) -> None:
        self.rounds = rounds
        self.class_weight = class_weight
        self.output = output
        self.criterion = criterion

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Train on n samples; see :meth:`placecue.classifier.Classifier.fit`.

        Raises
        ------
        UsageError
            If a parameter is not one of those above, or the features are not dense vectors.
        DataError
            If there is one class only, or a feature is NaN or infinite.
        """
        self._check_parameters()
        dense = self._dense(self.training_samples(self._only_dense(features), labels))
        codes = self.learn_classes(labels)
        ordered = SortedFeatures.of(dense)
        by_name = of_classes(self.class_weight, self.class_names)
        given = np.ones(len(self.labels_)) if by_name is None else by_name
        boosted = [
            self._boosted(dense, ordered, np.where(codes == code, 1.0, -1.0), given[codes])
            for code in track(range(len(self.labels_)), "boosting")
        ]
        self._keep(boosted)
        accepts = self._totals(dense) > 0
        self.errors_ = (accepts != (codes[:, None] == np.arange(len(self.labels_)))).mean(axis=0)
        self.order_ = [int(code) for code in np.argsort(self.errors_, kind="stable")]
        names = self.class_names
        if self.output == "probability":
            self.layout_ = Probabilities(names)
        else:
            self.layout_ = DecisionList(names, tuple(names[code] for code in self.order_))
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return the confidences or probabilities of n samples, shape (n, M)."""
        totals = self._totals(self._dense(self.samples(self._only_dense(features))))
        if self.output == "confidence":
            strength = self.alphas_.sum(axis=1)
            values = np.divide(totals, strength, out=np.zeros_like(totals), where=strength > 0)
        else:
            values = self._listed(totals)
        return Scores(values, self.layout_)

    def _boosted(
        self, features: Matrix, ordered: SortedFeatures, signs: Matrix, given: Matrix
    ) -> list[tuple[Stump, float]]:
        """Return stumps with their weights for samples of sign 1 against those of -1."""
        n = len(signs)
        weights = given / given.sum()
        if self.class_weight == "balanced":
            positive = (signs > 0).sum()
            weights = np.where(signs > 0, 0.5 / positive, 0.5 / (n - positive))
        boosted: list[tuple[Stump, float]] = []
        for _ in range(self.rounds):
            stump = ordered.best(signs, weights, self.criterion)
            right = signs * stump(features)
            error = float(weights[right < 0].sum())
            if error >= 0.5 - 1e-12:
                break
            # A stump without error would have infinite weight: as if half a sample were wrong.
            alpha = 0.5 * float(np.log(1 / (error or 0.5 / n) - 1))
            boosted.append((stump, alpha))
            if error <= 0:
                break
            weights *= np.exp(-alpha * right)
            weights /= weights.sum()
        return boosted

    def _keep(self, boosted: list[list[tuple[Stump, float]]]) -> None:
        shape = len(boosted), max(1, *map(len, boosted))
        self.features_ = np.zeros(shape, dtype=np.int64)
        self.left_, self.right_ = np.ones(shape, dtype=np.int64), np.ones(shape, dtype=np.int64)
        self.thresholds_, self.alphas_ = np.zeros(shape), np.zeros(shape)
        for code, of_class in enumerate(boosted):
            for number, (stump, alpha) in enumerate(of_class):
                self.features_[code, number] = stump.feature
                self.thresholds_[code, number] = stump.threshold
                self.left_[code, number] = stump.left
                self.right_[code, number] = stump.right
                self.alphas_[code, number] = alpha

    def _totals(self, features: Matrix) -> Matrix:
        """Return sum_t alpha_t h_t of each class, shape (n, M)."""
        totals = np.empty((len(features), len(self.alphas_)))
        for code, alphas in enumerate(self.alphas_):
            below = features[:, self.features_[code]] <= self.thresholds_[code]
            # einsum adds in one order whatever the number of rows; BLAS does not.
            said = np.where(below, self.left_[code], self.right_[code])
            totals[:, code] = np.einsum("nt,t->n", said, alphas)
        return totals

    def _listed(self, totals: Matrix) -> Matrix:
        """Return the probabilities that the list gives, shape (n, M)."""
        accept = (1 + np.tanh(totals[:, self.order_])) / 2
        accept[:, -1] = 1
        passed = np.cumprod(1 - accept[:, :-1], axis=1)
        accept[:, 1:] *= passed
        probabilities = np.empty_like(totals)
        probabilities[:, self.order_] = accept
        return probabilities

    def _only_dense(self, features: FeatureBatch) -> FeatureBatch:
        if kind_of(features) is not FeatureKind.DENSE:
            raise wrong_kind(self, "dense vectors", features)
        return features

    @staticmethod
    def _dense(features: FeatureBatch) -> Matrix:
        return np.asarray(features, dtype=np.float64)

    def _check_parameters(self) -> None:
        allowed = {"output": OUTPUTS, "criterion": CRITERIA}
        for name, values in allowed.items():
            value = getattr(self, name)
            if value not in values:
                raise UsageError(f"unknown {name} '{value}' of AdaBoost; {choices(value, values)}")
        check_class_weight(self.class_weight)
        if self.rounds < 1:
            raise UsageError(f"rounds must be 1 or more, got {self.rounds}")
