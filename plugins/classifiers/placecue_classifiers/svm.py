"""Support vector machine with the multi-class extensions of the paper."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import clone

from placecue.classifier import Classifier, FoldFeatures
from placecue.errors import UsageError, choices
from placecue.features import FeatureBatch, FeatureKind, take
from placecue.folds import FoldScheme, InterleavedChunks, Rows
from placecue.kernel import Gram, Kernel
from placecue.progress import track
from placecue.scaling import Scaling
from placecue.scores import (
    Layout,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
    Scores,
)
from placecue_classifiers import calibration
from placecue_classifiers.fold_groups import FoldGroup, folds
from placecue_classifiers.grid import OF_MACHINES, Grid, Setting
from placecue_classifiers.machines import Machines, one_against_all, one_against_one
from placecue_classifiers.prepared import Preparations, Prepared
from placecue_classifiers.search import best_of, search
from placecue_classifiers.weights import ClassWeight, check_class_weight, of_classes

MULTICLASS = ("oao", "oaa", "modified_oaa")


class SVM(Classifier):
    """C-SVC on a precomputed kernel, by LIBSVM.

    Parameters
    ----------
    kernel : Kernel
        How alike two samples are.
    C : float
        Cost of a margin violation.
    multiclass : {"oaa", "oao", "modified_oaa"}
        One-against-all (M functions, the largest wins), one-against-one (M (M - 1) / 2 functions,
        majority vote), or modified one-against-all (the class whose training mean the output lies
        nearest).
    class_weight : {"balanced"}, mapping of class to weight, or None
        Weight classes by inverse frequency, as given (1 where it is not), or not.
    scaling : Scaling, optional
        Scaling of dense features, learned on the training samples.
    search : mapping, optional
        Values to try by cross-validation on balanced accuracy, every combination of them:
        ``{"C": [...], "gamma": [...]}``, and likewise ``multiclass``, ``class_weight``,
        ``scaling`` and the kernel's parameters as ``kernel__NAME``. One Gram matrix serves every
        C, class weight, multi-class extension and fold; one matrix of distances every gamma, also
        of kernels inside a sum or product. Of a cue that learns, each fold has features and
        matrices of its own. What is left out stays as given.
    folds : FoldScheme, optional
        How the training samples are cut for search and calibration; interleaved chunks by default.
    probability : {"sigmoid", "isotonic"} or None
        Turn the outputs into probabilities, learned on held-out folds: Platt's sigmoid, or
        isotonic regression. The class then is the likeliest one.
    refit : bool
        After the search, train on all samples. If not, those that the one fold held out have
        chosen the parameters and are left at that: with ``folds=ByLog(only_last=True)`` the
        machines are trained on the logs before the last. Cue, scaling and kernel have learned from
        all samples either way.

    Attributes
    ----------
    layout_ : Layout
        What the columns of the scores are.
    machine_layout_ : Layout
        What the columns of the machines' outputs are; differs with ``probability`` only.
    C_ : float
        The cost in use.
    kernel_ : Kernel
        The kernel in use.
    scaling_ : Scaling or None
        The scaling in use.
    support_features_ : batch of k samples
        The union of the support vectors.
    coefficients_ : ndarray of float64, shape (k, V)
        Their signed dual coefficients.
    intercepts_ : ndarray of float64, shape (V,)
    calibrators_ : list of ndarray
        What turns each output into a probability; see :func:`calibration.calibrators`.
    search_ : dict of str to list
        For each point of the grid the searched parameters and ``balanced_accuracy``.
    chosen_ : dict
        The searched parameters that were best.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 3.3; Pronobis and Caputo, IROS 2007 (modified
    one-against-all); Platt, Probabilities for SV machines, 2000; Zadrozny and Elkan, KDD 2002.
    """

    def __init__(
        self,
        kernel: Kernel | None = None,
        C: float = 100.0,
        multiclass: str = "oaa",
        class_weight: ClassWeight = "balanced",
        scaling: Scaling | None = None,
        search: Mapping[str, Sequence[Any]] | None = None,
        folds: FoldScheme | None = None,
        probability: str | None = None,
        refit: bool = True,
    ) -> None:
        self.kernel = kernel
        self.C = C
        self.multiclass = multiclass
        self.class_weight = class_weight
        self.scaling = scaling
        self.search = search
        self.folds = folds
        self.probability = probability
        self.refit = refit

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Train on n samples; see :meth:`placecue.classifier.Classifier.fit`.

        Raises
        ------
        UsageError
            If a parameter is not one of those above, or the kernel cannot take these features.
        DataError
            If there is one class only, a feature is NaN or infinite, or, where folds are needed,
            a class has one sample only.
        """
        return self.fit_on_learned(features, labels, stamps)

    def fit_on_learned(
        self,
        features: FeatureBatch,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        learned_from: FoldFeatures | None = None,
    ) -> Self:
        """Train on features of a cue that has learned from them.

        In every fold of search and calibration cue, scaling and kernel learn from its training
        rows only; see :meth:`placecue.classifier.Classifier.fit_on_learned`.
        """
        self._check_parameters()
        features = self.training_samples(features, labels)
        codes = self.learn_classes(labels)
        grid = self._grid()
        prepared_for = self._preparing(grid)
        prepare = Preparations(lambda setting: prepared_for(setting, features, None))
        svm, setting, rows = self, Setting(), np.arange(len(codes))
        groups: list[FoldGroup] = []
        if self.search or self.probability:
            splits = self._splits(codes, stamps)
            groups = [FoldGroup(lambda: prepare, splits)]
            if learned_from is not None:
                of_fold = self.fold_features(learned_from, labels)
                groups = [FoldGroup.learned(of_fold, prepared_for, split) for split in splits]
        if self.search:
            rows = rows if self.refit else _one_training_part(splits)
            self.search_ = search(grid, groups, self.with_setting, codes, self.class_names)
            self.chosen_ = setting = best_of(self.search_)
            svm = self.with_setting(setting)
        preparation, light = grid.parted(setting)
        prepared = prepare(preparation)
        self.kernel_ = prepared.with_light(light)
        self.C_, self.scaling_ = float(svm.C), prepared.scaling
        gram = prepared.gram(light)
        block = gram if self.refit else gram[np.ix_(rows, rows)]
        machines = svm.machines(block, codes[rows], self.class_names)
        self.layout_ = svm.machine_layout(self.class_names, machines, block, codes[rows])
        self.machine_layout_ = self.layout_
        if self.probability is not None:
            each = track(folds(groups, preparation, light), "calibrating", len(splits))
            self.calibrators_ = svm.calibrated(each, codes, self.class_names)
            self.layout_ = Probabilities(self.class_names)
        support = np.flatnonzero(np.any(machines.coefficients != 0, axis=1))
        self.support_features_ = take(prepared.features, rows[support])
        self.coefficients_ = machines.coefficients[support]
        self.intercepts_ = machines.intercepts
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return the V discriminant functions of n samples, shape (n, V), or probabilities."""
        features = self.samples(features)
        if self.scaling_ is not None:
            features = self.scaling_.transform(np.asarray(features))
        gram = self.kernel_.gram(features, self.support_features_)
        values = Machines(self.coefficients_, self.intercepts_).decide(gram)
        if self.probability is not None:
            values = calibration.probabilities(
                self.probability, self.calibrators_, self.machine_layout_, values
            )
        return Scores(values, self.layout_)

    def chosen(self) -> Self:
        """Return an unfitted copy with the parameters that the search found."""
        copy: Self = self.with_setting(getattr(self, "chosen_", {}))
        copy.set_params(search=None, refit=True)
        return copy

    def out_of_fold(
        self,
        features: FeatureBatch,
        labels: NDArray[np.str_],
        stamps: NDArray[np.int64] | None,
        splits: Iterable[tuple[Rows, Rows]],
    ) -> Iterator[tuple[Rows, NDArray[np.float64]]]:
        """Yield what samples are scored by machines that have not seen them.

        One Gram matrix serves every fold, unless scaling or kernel learn from training samples;
        see :meth:`placecue.classifier.Classifier.out_of_fold`.
        """
        svm = self.chosen()
        prepared = None if svm.scaling is not None else svm.prepared(self.samples(features))
        if prepared is None or prepared.learned:
            yield from super().out_of_fold(features, labels, stamps, splits)
            return
        gram, codes = prepared.gram(), svm.learn_classes(labels)
        for training, held_out in splits:
            layout, values = svm._held_out(gram, codes, svm.class_names, training, held_out)
            if svm.probability is not None:
                block, of_fold = gram[np.ix_(training, training)], codes[training]
                inner = svm._splits(of_fold, None if stamps is None else stamps[training])
                parts = ((block, *split) for split in inner)
                calibrators = svm.calibrated(parts, of_fold, svm.class_names)
                values = calibration.probabilities(svm.probability, calibrators, layout, values)
            yield held_out, values

    # ------------------------------------------------------------------ what the search needs

    def with_setting(self, setting: Setting) -> Self:
        """Return an unfitted copy with the given parameters of a grid."""
        named = {"kernel__gamma" if n == "gamma" else n: v for n, v in setting.items()}
        copy: Self = clone(self).set_params(**named)
        copy._check_parameters()
        return copy

    def prepared(
        self, features: FeatureBatch, rows: Rows | None = None, light: bool = False
    ) -> Prepared:
        """Return n samples scaled, with the kernel; see :meth:`Prepared.of`."""
        assert self.kernel is not None
        return Prepared.of(features, self.kernel, self.scaling, rows, light)

    def machines(self, gram: Gram, codes: NDArray[np.int64], names: Sequence[str]) -> Machines:
        """Train the binary machines on an (n, n) Gram matrix."""
        train = one_against_one if self.multiclass == "oao" else one_against_all
        if self.class_weight == "balanced":
            return train(gram, codes, self.C, "balanced")
        return train(gram, codes, self.C, of_classes(self.class_weight, names))

    def same_machines(self) -> tuple[Any, ...]:
        """Return what the machines depend on: both kinds of one-against-all share them."""
        return self.multiclass == "oao", str(self.class_weight), self.C

    def machine_layout(
        self, names: Sequence[str], machines: Machines, gram: Gram, codes: NDArray[np.int64]
    ) -> Layout:
        """Return the layout that decides on the machines' outputs."""
        classes = tuple(names)
        if self.multiclass == "oao":
            return OneAgainstOne(classes)
        if self.multiclass == "oaa":
            return OneAgainstAll(classes)
        outputs = machines.decide(gram)
        means = [float(outputs[codes == code, code].mean()) for code in range(len(classes))]
        return ModifiedOneAgainstAll(classes, tuple(means))

    def calibrated(
        self,
        folds: Iterable[tuple[Gram, Rows, Rows]],
        codes: NDArray[np.int64],
        names: Sequence[str],
    ) -> list[NDArray[np.float64]]:
        """Learn probabilities from the outputs for held-out rows.

        A fold is an (n, n) Gram matrix with the training and the held-out rows.
        """
        outputs, truths = [], []
        for gram, training, held_out in folds:
            layout, values = self._held_out(gram, codes, names, training, held_out)
            if isinstance(layout, ModifiedOneAgainstAll):
                # Each fold has means of its own: what counts is the distance from them.
                values = values - np.asarray(layout.class_means)
                layout = ModifiedOneAgainstAll(layout.classes, (0.0,) * len(names))
            outputs.append(values)
            truths.append(codes[held_out])
        values, truth = np.concatenate(outputs), np.concatenate(truths)
        return calibration.calibrators(str(self.probability), layout, values, truth)

    # ------------------------------------------------------------------ privately

    def _held_out(
        self,
        gram: Gram,
        codes: NDArray[np.int64],
        names: Sequence[str],
        training: Rows,
        held_out: Rows,
    ) -> tuple[Layout, NDArray[np.float64]]:
        """Return the outputs for held-out rows of machines trained on others, and their layout."""
        block, of_block = gram[np.ix_(training, training)], codes[training]
        machines = self.machines(block, of_block, names)
        layout = self.machine_layout(names, machines, block, of_block)
        return layout, machines.decide(gram[np.ix_(held_out, training)])

    def _preparing(self, grid: Grid) -> Callable[[Setting, FeatureBatch, Rows | None], Prepared]:
        light = bool(grid.lights()[0])
        return lambda setting, features, rows: self.with_setting(setting).prepared(
            features, rows, light
        )

    def _grid(self) -> Grid:
        assert self.kernel is not None
        light = self.kernel.light_parameters
        names = [*OF_MACHINES, "scaling", *(name for name in light if name == "gamma")]
        names += [name for name in self.get_params() if name.startswith("kernel__")]
        return Grid.of(self.search or {}, names, light)

    def _splits(
        self, codes: NDArray[np.int64], stamps: ArrayLike | None
    ) -> list[tuple[Rows, Rows]]:
        names = np.asarray(self.class_names)
        return list((self.folds or InterleavedChunks()).split(names[codes], stamps))

    def _check_parameters(self) -> None:
        allowed = {
            "multiclass": MULTICLASS,
            "probability": (*calibration.METHODS, None),
        }
        for name, values in allowed.items():
            value = getattr(self, name)
            if value not in values:
                known = choices(str(value), [v for v in values if v is not None])
                null = ", or null" if None in values else ""
                raise UsageError(f"unknown {name} '{value}' of an SVM; {known}{null}")
        check_class_weight(self.class_weight)
        if self.kernel is None:
            raise UsageError("an SVM needs a kernel, such as kernel={plugin: rbf}")
        if not self.C > 0:
            raise UsageError(f"C must be above 0, got {self.C}")
        if self.folds is not None:
            if not isinstance(self.folds, FoldScheme):
                raise UsageError(f"folds must be a FoldScheme, such as Blocks(), got {self.folds}")
            self.folds.check_parameters()
        if not (self.refit or self.search):
            raise UsageError("refit=false keeps what a search held out: give search, or refit=true")

    def __sklearn_tags__(self) -> Any:
        """Return what scikit-learn is told of the estimator: whether it takes sparse input."""
        tags = super().__sklearn_tags__()
        accepted = self.kernel.accepts if self.kernel is not None else ()
        tags.input_tags.sparse = FeatureKind.SPARSE in accepted and self.scaling is None
        return tags


def _one_training_part(splits: Sequence[tuple[Rows, Rows]]) -> Rows:
    """Return the training rows of the only split."""
    if len(splits) != 1:
        raise UsageError(
            f"refit=false needs folds that hold out samples once, and these do {len(splits)} "
            "times: choose folds={plugin: by_log, only_last: true}"
        )
    return splits[0][0]
