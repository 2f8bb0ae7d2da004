"""Any classifier of scikit-learn, by its dotted name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from sklearn.base import clone

from placecue import estimators
from placecue.classifier import Classifier, UnfitSamples, wrong_kind
from placecue.errors import UsageError
from placecue.features import Families, FeatureBatch, FeatureKind, kind_of
from placecue.scaling import Scaling
from placecue.scores import OneAgainstAll, Probabilities, Scores
from placecue.training_set import TrainingSet
from placecue_classifiers.prepared import fitted_scaling, transformed


class ScikitLearn(Classifier):
    """A classifier of scikit-learn on dense vectors or sparse histograms.

    Scores are its probabilities where it gives them, else its decision function.

    scikit-learn keeps what it has learned in objects that only pickle can store, and a model
    folder holds none. So what is learned here are the training samples themselves, arrays whose
    digest the model's manifest holds: a model that was loaded fits the estimator on them, and on
    nothing else, when it is first asked, with the same random state, which gives the same
    predictions with the same version of scikit-learn. Reading a model fits nothing. Which
    parameters ``params`` may set, and to what, is the same for a config and a model folder: plain
    data that names no file, function or process (:mod:`placecue.estimators`).

    Parameters
    ----------
    estimator : str
        Dotted name of the class, such as ``sklearn.ensemble.RandomForestClassifier``.
        scikit-learn's own, unless a plugin allows more (:mod:`placecue.estimators`).
    params : mapping, optional
        Its parameters, plain data. One that is an estimator itself is a mapping with
        ``estimator`` and ``params``.
    random_state : int
        For every random state that ``params`` leaves open.
    scaling : Scaling, optional
        Scaling of dense features, learned on the training samples.

    Attributes
    ----------
    layout_ : Probabilities or OneAgainstAll
        What the columns of the scores are.
    features_ : batch of n samples
        The training samples, scaled, without columns that are empty in all of them.
    codes_ : ndarray of int64, shape (n,)
        Their classes as numbers.
    columns_ : ndarray of int64 or None
        Of sparse histograms, the columns that are not empty.
    scaling_ : Scaling or None
        The scaling in use.
    """

    def __init__(
        self,
        estimator: str = "sklearn.ensemble.RandomForestClassifier",
        params: Mapping[str, Any] | None = None,
        random_state: int = 0,
        scaling: Scaling | None = None,
    ) -> None:
        self.estimator = estimator
        self.params = params
        self.random_state = random_state
        self.scaling = scaling

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Train on n samples; see :meth:`placecue.classifier.Classifier.fit`.

        Raises
        ------
        UsageError
            If there is no such estimator, it refuses a parameter, or the features are sets of
            descriptors.
        DataError
            If there is one class only, a feature is NaN or infinite, or the estimator refuses the
            samples.
        """
        return self._learn(features, labels, None)

    def train(self, training: TrainingSet) -> Self:
        """Train on samples and their augmented copies; see :meth:`Classifier.train`."""
        labels = training.repeated(training.labels)
        return self._learn(training.batch(), labels, training.families)

    def _learn(self, features: FeatureBatch, labels: Any, families: Families | None) -> Self:
        self._estimator = self._built()
        features = self.training_samples(self._accepted(features), labels)
        self.codes_ = self.learn_classes(labels)
        self.scaling_ = fitted_scaling(features, self.scaling, families)
        self.columns_ = None
        if isinstance(features, sparse.csr_array):
            self.columns_ = np.unique(features.indices)
        self.features_ = self._prepared(features)
        self._train(self._estimator)
        probable = hasattr(self._estimator, "predict_proba")
        self.layout_ = (Probabilities if probable else OneAgainstAll)(self.class_names)
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return probabilities or decision values of n samples, shape (n, M)."""
        features = self._prepared(self.samples(self._accepted(features)))
        fitted = self.fitted()
        if isinstance(self.layout_, Probabilities):
            return Scores(np.asarray(fitted.predict_proba(features)), self.layout_)
        values = np.asarray(fitted.decision_function(features), dtype=np.float64)
        if values.ndim == 1:
            values = np.stack([-values, values], axis=1)
        return Scores(values, self.layout_)

    def fitted(self) -> Any:
        """Return the fitted estimator, fitting it again in a model that was loaded."""
        if not hasattr(self, "_estimator"):
            built = self._built()
            self._train(built)
            self._estimator = built
        return self._estimator

    def check_learned(self) -> None:
        """Check what a model folder says, before the estimator is fitted on it.

        Raises
        ------
        ValueError
            If the samples, their classes and their columns do not fit together.
        UsageError
            If the estimator or a parameter of it is not allowed.
        """
        self._built()
        codes, width = np.asarray(self.codes_), int(self.features_.shape[1])
        if codes.shape != (self.features_.shape[0],) or codes.dtype.kind != "i":
            raise ValueError(f"{self.features_.shape} samples and {codes.shape} classes of them")
        if not np.array_equal(np.unique(codes), np.arange(len(self.labels_))):
            raise ValueError("the classes of the samples are not those of labels_")
        columns = self.columns_
        if columns is not None and (columns.shape != (width,) or (np.diff(columns) <= 0).any()):
            raise ValueError("columns_ are not those of the samples")

    def _built(self) -> Any:
        built = estimators.classifier(self.estimator, self.params)
        open_states = {
            name: self.random_state
            for name, value in built.get_params().items()
            if name.split("__")[-1] == "random_state" and value is None
        }
        built.set_params(**open_states)
        if not hasattr(built, "predict_proba") and not hasattr(built, "decision_function"):
            raise UsageError(
                f"{self.estimator} has neither probabilities nor a decision function: choose "
                "another, or other parameters of it"
            )
        if built.get_params().get("decision_function_shape") == "ovo":
            raise UsageError(
                f"{self.estimator} gives decision values of pairs of classes: set "
                "decision_function_shape=ovr, or use the classifier svm with multiclass=oao"
            )
        return built

    def _train(self, estimator: Any) -> None:
        try:
            estimator.fit(self.features_, self.codes_)
        except Exception as error:  # it need not be scikit-learn's own
            reason = " ".join(str(error).split())
            raise UnfitSamples(f"{self.estimator} refused the samples: {reason}") from error

    def _accepted(self, features: FeatureBatch) -> FeatureBatch:
        if kind_of(features) in (FeatureKind.DESCRIPTORS, FeatureKind.PARTS):
            raise wrong_kind(self, "dense vectors or sparse histograms", features)
        return features

    def _prepared(self, features: FeatureBatch) -> FeatureBatch:
        if self.scaling_ is not None:
            return transformed(self.scaling_, features)
        return features if self.columns_ is None else _only(features, self.columns_)

    def __sklearn_tags__(self) -> Any:
        """Return what scikit-learn is told of the estimator: whether it takes sparse input."""
        tags = super().__sklearn_tags__()
        tags.input_tags.sparse = clone(self)._built().__sklearn_tags__().input_tags.sparse
        return tags

    def __getstate__(self) -> dict[str, Any]:
        """Return the state without the fitted estimator, which is fitted again when asked."""
        return {name: v for name, v in super().__getstate__().items() if name != "_estimator"}


def _only(rows: sparse.csr_array, columns: NDArray[np.integer]) -> sparse.csr_array:
    """Return the given columns (sorted) of sparse rows, shape (n, k); CRFH has 28**6 columns."""
    places = np.searchsorted(columns, rows.indices)
    found = places < len(columns)
    found[found] = columns[places[found]] == rows.indices[found]
    starts = np.concatenate([[0], np.cumsum(found)])[rows.indptr]
    kept = rows.data[found], places[found].astype(np.int32), starts.astype(np.int32)
    return sparse.csr_array(kept, shape=(rows.shape[0], len(columns)))
