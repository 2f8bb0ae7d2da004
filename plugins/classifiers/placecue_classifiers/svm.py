"""Support vector machine with the multi-class extensions of the paper."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import product
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.classifier import Classifier
from placecue.errors import UsageError, choices, described
from placecue.estimator import clone
from placecue.features import FeatureBatch, FeatureKind, take
from placecue.folds import FoldScheme, Rows
from placecue.grams import Known, current
from placecue.guard import step
from placecue.kernel import Gram, Kernel
from placecue.progress import track
from placecue.scaling import Scaling
from placecue.scores import Layout, Probabilities, Scores
from placecue.training_set import TrainingSet
from placecue_classifiers import calibration
from placecue_classifiers.convergence import told_once
from placecue_classifiers.grid import OF_MACHINES, Grid, Setting
from placecue_classifiers.machines import Codes, Machines, Weights
from placecue_classifiers.multiclass import LAYOUTS, Multiclass
from placecue_classifiers.prepared import Prepared, learns, remembering, transformed
from placecue_classifiers.search import Folds, best_of, search
from placecue_classifiers.weights import ClassWeight, check_class_weight, of_classes


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
        Scaling of dense features, learned on the training samples; of features in parts each dense
        part is scaled by itself, and the others are left alone.
    search : mapping, optional
        Values to try by cross-validation on balanced accuracy, every combination of them:
        ``{"C": [...], "gamma": [...]}``, and likewise ``multiclass``, ``class_weight``,
        ``scaling`` and the kernel's parameters as ``kernel__NAME``. One Gram matrix serves every
        C, class weight, multi-class extension and fold; one matrix of distances every gamma, also
        of kernels inside a sum or product. Where cue, scaling or kernel learn from samples, each
        fold has its own, learned from its training rows. What is left out stays as given.
    folds : FoldScheme, optional
        How the training samples are cut for search and calibration; by default as the training
        set says, which a pipeline gives its own scheme.
    probability : {"sigmoid", "isotonic"} or None
        Turn the outputs into probabilities, learned on held-out folds: Platt's sigmoid, or
        isotonic regression. The class then is the likeliest one.
    refit : bool
        After the search, train on all samples. If not, those that the one fold held out have
        chosen the parameters and are left at that: with ``folds=ByLog(only_last=True)`` the
        machines are trained on the logs before the last. Cue, scaling and kernel have learned
        from all samples either way.

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
    scaling_ : Scaling, dict of str to Scaling, or None
        The scaling in use; that of each dense part, by its name.
    support_ : ndarray of int64, shape (k,)
        Which rows of the training batch are support vectors of any machine.
    support_features_ : batch of k samples
        These, scaled.
    samples_ : str or None
        What :meth:`placecue.Grams.known` called the training batch.
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
        return self.train(TrainingSet(features, labels, stamps))

    @told_once
    def train(self, training: TrainingSet) -> Self:
        """Search if that is asked for, then train; see :meth:`Classifier.train`."""
        self._check_parameters()
        training = self.checked(training)
        codes = self.codes(training.repeated(training.labels))
        grid = self._grid()
        prepare = remembering(self._preparing(grid, training))
        folds = self._folds(grid, training, prepare) if self.search or self.probability else []
        best, setting, rows = self, Setting(), np.arange(len(codes))
        if self.search:
            # What is left of the logs in a fold may be one log, and then is held out in turn.
            whole = self.refit or (training.part and sum(len(each.splits) for each in folds) > 1)
            rows = rows if whole else _one_training_part(folds)
            extensions = [self.with_setting(each)._extension(self) for each in grid.machines()]
            self.search_ = search(grid, folds, extensions, codes)
            self.chosen_ = setting = best_of(self.search_)
            best = self.with_setting(setting)
        extension = best._extension(self)
        preparation, light = grid.parted(setting)
        prepared = prepare(preparation)
        gram = prepared.gram(light)
        machines = extension.machines(gram[np.ix_(rows, rows)], codes[rows])
        self.layout_ = self.machine_layout_ = extension.layout
        if self.probability is not None:
            of_folds = (each for alike in folds for each in alike.rounds([(preparation, light)]))
            held_out = ((gram, *split) for gram, splits in of_folds for split in splits)
            total = sum(len(alike.splits) for alike in folds)
            each = track(held_out, "calibrating", total)
            self.calibrators_ = self._calibrators(extension, codes, each)
            self.layout_ = Probabilities(self.class_names)
        self.C_, self.scaling_ = float(best.C), prepared.scaling
        self.kernel_ = prepared.with_light(light)
        self._keep(machines, prepared.features, rows)
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return the V discriminant functions of n samples, shape (n, V), or probabilities."""
        features = self.samples(features)
        if self.scaling_ is not None:
            features = transformed(self.scaling_, features)
        known = Known(self.support_features_, self.support_, self.samples_)
        gram = current().against(self.kernel_, features, known)
        values = Machines(self.coefficients_, self.intercepts_).decide(gram)
        return Scores(self._as_asked(values, self.machine_layout_), self.layout_)

    def best(self) -> Self:
        """Return an unfitted copy with the parameters that the search found."""
        copy: Self = self.with_setting(getattr(self, "chosen_", {}))
        copy.set_params(search=None, refit=True)
        return copy

    def candidates(self) -> Iterator[tuple[Setting, SVM]]:
        """Yield the points of the search, light parameters of the kernel next to one another."""
        grid = self._grid()
        for preparation, light, machines in product(
            grid.preparations(), grid.lights(), grid.machines()
        ):
            setting = {**preparation, **light, **machines}
            yield setting, self.with_setting(setting).set_params(search=None, refit=True)

    def out_of_fold(
        self, training: TrainingSet, splits: Iterable[tuple[Rows, Rows]]
    ) -> Iterator[tuple[Rows, Scores]]:
        """Yield what samples are scored by machines that have not seen them.

        One Gram matrix serves every fold, unless cue, scaling or kernel learn from training
        samples; see :meth:`placecue.classifier.Classifier.out_of_fold`.
        """
        svm = self.best()
        training = svm.checked(training)
        if svm._learns(training, [svm.scaling]):
            yield from super().out_of_fold(training, splits)
            return
        codes, extension = svm.codes(training.repeated(training.labels)), svm._extension(svm)
        gram = svm._preparing(svm._grid(), training)({}).gram()
        for rows, held_out in splits:
            flat = training.copies(rows), training.recorded(held_out)
            values = extension.held_out(gram, codes, *flat)
            layout = extension.layout
            if svm.probability is not None:
                inner = training.take(rows).split(svm.folds)
                parts = (
                    (gram, training.copies(rows[a]), training.recorded(rows[b])) for a, b in inner
                )
                svm.calibrators_ = svm._calibrators(extension, codes, parts)
                values, layout = svm._as_asked(values, layout), Probabilities(svm.class_names)
            yield held_out, Scores(values, layout)

    def with_setting(self, setting: Setting) -> Self:
        """Return an unfitted copy with the given parameters of a grid."""
        named = {"kernel__gamma" if n == "gamma" else n: v for n, v in setting.items()}
        copy: Self = clone(self).set_params(**named)
        copy._check_parameters()
        return copy

    # ------------------------------------------------------------------ privately

    def _keep(self, machines: Machines, features: FeatureBatch, rows: Rows) -> None:
        support = np.flatnonzero(np.any(machines.coefficients != 0, axis=1))
        self.support_ = rows[support]
        self.support_features_ = take(features, self.support_)
        self.samples_ = current().known(features)
        self.coefficients_ = machines.coefficients[support]
        self.intercepts_ = machines.intercepts

    def _extension(self, fitted: SVM) -> Multiclass:
        """Return this SVM's multi-class extension over the classes of a fitted one."""
        names = fitted.class_names
        weights = self.class_weight
        by_name: Weights = of_classes(weights, names)
        if weights == "balanced":
            by_name = "balanced"
        return Multiclass(self.multiclass, names, self.C, by_name)

    def _preparing(self, grid: Grid, training: TrainingSet) -> Callable[..., Prepared]:
        """Return what prepares n samples for the parameters of a grid."""
        light, features, families = bool(grid.lights()[0]), training.batch(), training.families
        labels = training.repeated(training.labels)

        def prepare(setting: Setting, rows: Rows | None = None) -> Prepared:
            svm = self.with_setting(setting)
            assert svm.kernel is not None
            return Prepared.of(features, svm.kernel, svm.scaling, rows, light, families, labels)

        return prepare

    def _folds(
        self, grid: Grid, training: TrainingSet, prepare: Callable[[Setting], Prepared]
    ) -> list[Folds]:
        """Return the folds, together where they may share a Gram matrix."""
        splits = training.split(self.folds)
        flat = [(training.copies(rows), training.recorded(held)) for rows, held in splits]
        if not self._learns(training, grid.values.get("scaling", [self.scaling])):
            return [Folds(lambda: prepare, flat)]

        def of_fold(rows: Rows, flat_rows: Rows) -> Callable[[Setting], Prepared]:
            relearned = training.relearned(rows)
            return remembering(partial(self._preparing(grid, relearned), rows=flat_rows))

        return [
            Folds(partial(of_fold, rows, each[0]), [each])
            for (rows, _), each in zip(splits, flat, strict=True)
        ]

    def _learns(self, training: TrainingSet, scalings: Iterable[Scaling | None]) -> bool:
        """Tell whether cue, scaling or kernel depend on which samples they learn from."""
        if training.relearn is not None or any(each is not None for each in scalings):
            return True
        assert self.kernel is not None
        return learns(self.kernel, training.features)

    def _calibrators(
        self,
        extension: Multiclass,
        codes: Codes,
        held_out: Iterable[tuple[Gram, Rows, Rows]],
    ) -> list[NDArray[np.float64]]:
        """Learn probabilities from the outputs for held-out rows (matrix, training, held out)."""
        outputs, truths = [], []
        for gram, rows, held in held_out:
            outputs.append(extension.held_out(gram, codes, rows, held))
            truths.append(codes[held])
        assert self.probability is not None
        values, truth = np.concatenate(outputs), np.concatenate(truths)
        return calibration.calibrators(self.probability, extension.layout, values, truth)

    def _as_asked(self, values: NDArray[np.float64], layout: Layout) -> NDArray[np.float64]:
        """Return outputs of machines as they are, or as probabilities."""
        if self.probability is None:
            return values
        return calibration.probabilities(self.probability, self.calibrators_, layout, values)

    def _grid(self) -> Grid:
        assert self.kernel is not None
        light = step(self.kernel, "light_parameters", _light_parameters, self.kernel, check=_names)
        names = [*OF_MACHINES, "scaling", *(name for name in light if name == "gamma")]
        names += [name for name in self.get_params() if name.startswith("kernel__")]
        return Grid.of(self.search or {}, names, light)

    def _check_parameters(self) -> None:
        allowed = {
            "multiclass": tuple(LAYOUTS),
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
        for name, kind in (("scaling", Scaling), ("folds", FoldScheme)):
            given = getattr(self, name)
            if given is not None and not isinstance(given, kind):
                raise UsageError(f"{name} must be a {kind.__name__} or None, got {given!r}")
        if self.folds is not None:
            self.folds.check_parameters()
        if not self.C > 0:
            raise UsageError(f"C must be above 0, got {self.C}")
        if not (self.refit or self.search):
            raise UsageError("refit=false keeps what a search held out: give search, or refit=true")

    def __sklearn_tags__(self) -> Any:
        """Return what scikit-learn is told of the estimator: whether it takes sparse input."""
        tags = super().__sklearn_tags__()
        accepted = self.kernel.accepts if self.kernel is not None else ()
        tags.input_tags.sparse = FeatureKind.SPARSE in accepted and self.scaling is None
        return tags


def _one_training_part(folds: Sequence[Folds]) -> Rows:
    """Return the training rows of the only split."""
    splits = [split for alike in folds for split in alike.splits]
    if len(splits) != 1:
        raise UsageError(
            f"refit=false needs folds that hold out samples once, and these do {len(splits)} "
            "times: choose folds={plugin: by_log, only_last: true}"
        )
    return splits[0][0]


def _light_parameters(kernel: Kernel) -> tuple[str, ...]:
    return kernel.light_parameters


def _names(made: object) -> str | None:
    """Check that a kernel names its light parameters."""
    right = isinstance(made, (tuple, list)) and all(isinstance(name, str) for name in made)
    return None if right else f"is {described(made)}, not a tuple of names"
