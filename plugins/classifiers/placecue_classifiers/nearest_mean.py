"""Nearest class mean on features of unit length, which goes on learning exactly."""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import cho_factor, cho_solve
from sklearn.utils.validation import column_or_1d

from placecue.checks import check_choice, check_number
from placecue.classifier import Classifier, UnfitSamples, wrong_kind
from placecue.errors import UsageError
from placecue.features import FeatureBatch, FeatureKind, kind_of
from placecue.scaling import unit_length
from placecue.scores import OneAgainstAll, Scores

Matrix = NDArray[np.float64]

COVARIANCES = ("none", "shared")
#: Features are rounded to multiples of it, so that their sums are whole numbers of it.
STEP = 2.0**-22
#: So many rows of unit length have products whose sums a float64 holds exactly.
_ROWS = 512
#: A variance of vectors of unit length that is rounding alone.
_NOTHING = 1e-9
#: Sums of products fill an int64 beyond so many samples.
MOST = 2**19


class NearestMean(Classifier):
    """The class whose mean is nearest, on features of unit length; learns sample by sample.

    Scores are twice the dot product with a class mean less the mean's squared length: the largest
    is that of the nearest mean. With a shared covariance they are the linear discriminants of
    equally frequent classes.

    What is learned are sums. Features are rounded to multiples of 2**-22 first, so that sums are
    whole numbers, exact: however the samples are cut and ordered, :meth:`partial_fit` comes to the
    same as :meth:`fit`, to the last bit.

    Parameters
    ----------
    covariance : {"none", "shared"}
        Euclidean distances, or those by the covariance within classes, one for all of them (linear
        discriminant analysis).
    shrinkage : float or "oas"
        How far the covariance is drawn to a multiple of the identity, 0 to 1; "oas" estimates it
        from the samples.

    Attributes
    ----------
    layout_ : OneAgainstAll
        Not there before samples of two classes have been seen.
    counts_ : ndarray of int64, shape (M,)
        Samples of each class.
    sums_ : ndarray of int64, shape (M, d)
        Sums of their features, in steps of 2**-22.
    products_ : ndarray of int64, shape (d, d), or None
        Sum of the products of features of all samples, in steps of 2**-44; with a covariance only.

    References
    ----------
    Mensink, Verbeek, Perronnin and Csurka, Distance-based image classification: generalizing to
    new classes at near-zero cost, PAMI 35(11), 2013; Chen, Wiesel, Eldar and Hero, Shrinkage
    algorithms for MMSE covariance estimation, IEEE Trans. Signal Processing 58(10), 2010 (OAS).
    """

    def __init__(self, covariance: str = "none", shrinkage: float | str = "oas") -> None:
        self.covariance = covariance
        self.shrinkage = shrinkage

    def check_parameters(self) -> None:  # noqa: D102
        check_choice("covariance", self.covariance, COVARIANCES)
        if self.shrinkage != "oas":
            if isinstance(self.shrinkage, str):
                raise UsageError(f"shrinkage is {self.shrinkage!r}; give 0 to 1, or oas")
            check_number("shrinkage", self.shrinkage, least=0, most=1)

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Learn from n samples; see :meth:`placecue.classifier.Classifier.fit`.

        Raises
        ------
        DataError
            If there is one class only, or a feature is NaN or infinite.
        """
        for name in ("labels_", "layout_", "counts_", "sums_", "products_"):
            self.__dict__.pop(name, None)
        self.check_parameters()
        checked = self.training_samples(self._dense(features), labels)
        codes = self.learn_classes(labels)
        width = checked.shape[1]
        self.counts_ = np.zeros(len(self.labels_), np.int64)
        self.sums_ = np.zeros((len(self.labels_), width), np.int64)
        self.products_ = None if self.covariance == "none" else np.zeros((width, width), np.int64)
        return self._add(checked, codes)

    def partial_fit(
        self, features: FeatureBatch, labels: ArrayLike, classes: ArrayLike | None = None
    ) -> Self:
        """Learn from n more samples, of known classes or new ones.

        Parameters
        ----------
        features : ndarray, shape (n, d)
        labels : array of str or int, shape (n,)
        classes : array, optional
            All classes that there may be; a label of another is refused.

        Raises
        ------
        DataError
            If the features are not as long as before, not finite, or a label is none of
            ``classes``.
        """
        self.check_parameters()
        given = column_or_1d(labels)
        given = given.astype(np.str_) if given.dtype.kind == "O" else given
        if classes is not None and not np.isin(given, np.asarray(classes)).all():
            other = given[~np.isin(given, np.asarray(classes))][0]
            raise UnfitSamples(f"a sample is labelled '{other}', which is none of the classes")
        if not hasattr(self, "sums_"):
            checked = self.training_samples(self._dense(features), given)
            self._begin(given.dtype, checked.shape[1])
        else:
            checked = self._more(features, given)
        self._extend(given)
        return self._add(checked, np.searchsorted(self.labels_, given))

    def scores(self, features: FeatureBatch) -> Scores:
        """Return how near n samples are to each class mean, shape (n, M)."""
        rows = _rounded(np.asarray(self.samples(self._dense(features)), np.float64)) * STEP
        if not hasattr(self, "_discriminants"):  # a model that was loaded
            self._discriminants = self._solved()
        weights, offsets = self._discriminants
        return Scores(rows @ weights + offsets, self.layout_)

    @property
    def means_(self) -> Matrix:
        """The mean of each class, shape (M, d)."""
        return np.asarray(self.sums_ * STEP / self.counts_[:, None])

    def check_learned(self) -> None:
        """Raise ValueError unless what a model folder says fits together."""
        classes, (rows, width) = len(self.labels_), self.sums_.shape
        if rows != classes or self.counts_.shape != (classes,) or (self.counts_ < 1).any():
            raise ValueError("counts_, sums_ and labels_ are not of the same classes")
        square = self.products_ is None or self.products_.shape == (width, width)
        if not square or (self.products_ is None) != (self.covariance == "none"):
            raise ValueError("products_ are not those of the features")

    # ------------------------------------------------------------------ privately

    def _begin(self, kind: np.dtype[Any], width: int) -> None:
        self.labels_ = np.empty(0, kind)
        self.counts_ = np.zeros(0, np.int64)
        self.sums_ = np.zeros((0, width), np.int64)
        self.products_ = None if self.covariance == "none" else np.zeros((width, width), np.int64)

    def _extend(self, labels: NDArray[Any]) -> None:
        """Make room for classes that are new."""
        known = self.labels_
        self.labels_ = np.unique(np.concatenate([known, labels]))
        places = np.searchsorted(self.labels_, known)
        counts, sums = self.counts_, self.sums_
        self.counts_ = np.zeros(len(self.labels_), np.int64)
        self.sums_ = np.zeros((len(self.labels_), sums.shape[1]), np.int64)
        self.counts_[places], self.sums_[places] = counts, sums

    def _add(self, features: FeatureBatch, codes: NDArray[Any]) -> Self:
        rows = _rounded(np.asarray(features, np.float64))
        if self.counts_.sum() + len(rows) > MOST:
            raise UnfitSamples(f"nearest_mean adds up at most {MOST} samples")
        np.add.at(self.counts_, codes, 1)
        np.add.at(self.sums_, codes, rows.astype(np.int64))
        if self.products_ is not None:
            for first in range(0, len(rows), _ROWS):
                some = rows[first : first + _ROWS]
                self.products_ += (some.T @ some).astype(np.int64)
        if len(self.labels_) > 1:
            self.layout_ = OneAgainstAll(self.class_names)
            self._discriminants = self._solved()
        return self

    def _more(self, features: FeatureBatch, labels: NDArray[Any]) -> FeatureBatch:
        """Return further training features, checked."""
        dense = self._dense(features)
        self._check_width(dense)
        checked = self._some_and_finite(self._validated(dense, reset=False))
        if len(labels) != checked.shape[0]:
            raise UnfitSamples(f"{checked.shape[0]} samples and {len(labels)} labels")
        return checked

    def _solved(self) -> tuple[Matrix, Matrix]:
        """Return weights, shape (d, M), and offsets, shape (M,), of the scores."""
        means = self.means_
        if self.products_ is None:
            return np.asarray(2 * means.T), np.asarray(-np.sum(means**2, axis=1))
        total = int(self.counts_.sum())
        within = self.products_ * STEP**2 - (self.counts_[:, None] * means).T @ means
        shrunk = shrunken(within / total, total, self.shrinkage)
        try:
            weights = cho_solve(cho_factor(shrunk), means.T)
        except np.linalg.LinAlgError:  # nothing was shrunk, and some features do not vary
            weights = np.linalg.lstsq(shrunk, means.T, rcond=None)[0]
        return np.asarray(weights), np.asarray(-np.sum(means.T * weights, axis=0) / 2)

    def _dense(self, features: FeatureBatch) -> FeatureBatch:
        kind = kind_of(features) if not isinstance(features, list) else FeatureKind.DENSE
        if kind is not FeatureKind.DENSE:
            raise wrong_kind(self, "dense vectors", features)
        return features


def shrunken(covariance: Matrix, n: int, shrinkage: float | str) -> Matrix:
    """Return a covariance of n samples, shape (d, d), drawn to a multiple of the identity.

    Where nothing varies, as with one sample a class, it is the identity.
    """
    d = len(covariance)
    mean = np.trace(covariance) / d
    if mean * d < _NOTHING:
        return np.eye(d)
    share = shrinkage
    if share == "oas":
        square, trace = np.sum(covariance**2), np.trace(covariance) ** 2
        below = (n + 1 - 2 / d) * (square - trace / d)
        share = 1.0 if below <= 0 else min(1.0, float(((1 - 2 / d) * square + trace) / below))
    assert not isinstance(share, str)
    return np.asarray((1 - share) * covariance + share * mean * np.eye(d))


def _rounded(features: Matrix) -> Matrix:
    """Return features of unit length as whole numbers of steps, in float64."""
    return np.asarray(np.rint(unit_length(features) / STEP))
