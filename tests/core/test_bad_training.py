"""Components that misbehave while a pipeline is trained: the error names them, and no other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from misbehaving import MISDEEDS
from placecue import (
    Classifier,
    Cue,
    FoldScheme,
    Integrator,
    Kernel,
    Pipeline,
    Scaling,
    Scores,
)
from placecue.errors import ComponentError, ContractError
from placecue.estimator import clone
from placecue.features import FeatureKind
from placecue.learning.rejection import Unknown
from placecue.scores import OneAgainstAll
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from toys import PLACES, Beams, Walk

raises = MISDEEDS["raises"][0]
Deed = Callable[..., Any]


class Means(Classifier):
    """Scores by the distance to the mean of each class; then does something else."""

    def __init__(self, deed: Deed | None = None) -> None:
        self.deed = deed

    def fit(self, features: Any, labels: Any, stamps: Any = None) -> Means:
        codes = self.learn_classes(labels)
        self.layout_ = OneAgainstAll(self.class_names)
        self.means_ = np.array([features[codes == code].mean(axis=0) for code in np.unique(codes)])
        if self.deed is not None:
            self.deed(self)
        return self

    def scores(self, features: Any) -> Scores:
        away = np.linalg.norm(features[:, None] - self.means_, axis=2)
        return Scores(-away, self.layout_)


def fit(**parts: Any) -> None:
    cue = parts.get("cue", Beams())
    second = (Beams(2), Means())
    integrator = parts.get("integrator")
    cues = {"beams": (cue, parts.get("classifier", Means()))}
    if integrator is not None:
        cues["second"] = second
    made = Pipeline(cues, integrator, parts.get("folds"), parts.get("unknown"))
    made.fit(Walk(rounds=2), parts.get("integration"))


# ---------------------------------------------------------------------- classifiers


def sets(name: str, value: Any) -> Deed:
    return lambda classifier: setattr(classifier, name, value)


@pytest.mark.parametrize(
    ("deed", "said"),
    [
        (lambda classifier: delattr(classifier, "layout_"), "left None as layout_, not a Layout"),
        (sets("layout_", "one against all"), "left a str as layout_, not a Layout"),
        (
            sets("layout_", OneAgainstAll(("a", "b", "c", "d"))),
            "left a layout_ of the classes a, b, c, d, where the samples are of "
            + ", ".join(PLACES),
        ),
        (sets("layout_", OneAgainstAll(PLACES[::-1])), "left a layout_ of the classes office, lab"),
        (sets("labels_", 5), "left an int as labels_, not 4 labels"),
        (sets("labels_", np.array(PLACES[:3])), "left a ndarray as labels_, not 4 labels"),
    ],
)
def test_a_classifier_of_other_classes_than_it_was_given(deed: Deed, said: str) -> None:
    with pytest.raises(ContractError, match=rf"^classifier Means \({__name__}\): train {said}"):
        fit(classifier=Means(deed))


# ---------------------------------------------------------------------- cues


class Augmenting(Beams):
    """Has odd augmentations."""

    def __init__(self, deed: Deed = list) -> None:
        super().__init__()
        self.deed = deed

    def augmentations(self) -> Any:
        return self.deed()


@pytest.mark.parametrize("learns", [False, True])
@pytest.mark.parametrize(
    ("deed", "said"),
    [
        (raises, "failed: ValueError: two lines"),
        (MISDEEDS["leaves"][0], "failed: SystemExit: 3"),
        (lambda: None, "returned None, not a sequence of functions"),
        (lambda: (5,), "returned an int among its functions"),
    ],
)
def test_augmentations_that_are_none(deed: Deed, said: str, learns: bool) -> None:
    cue: Cue = type("Augmenting", (Augmenting,), {"learns": learns, "__module__": __name__})(deed)
    who = rf"cue Augmenting \({__name__}\)"
    with pytest.raises(ComponentError, match=f"^{who}: augmentations {said}"):
        fit(cue=cue)


# ---------------------------------------------------------------------- kernels, scalings


class Odd(Kernel):
    """The linear kernel, with one method that does something else."""

    accepts = frozenset(FeatureKind)

    def __init__(self, gamma: float = 0.1, method: str = "", deed: Deed = raises) -> None:
        self.gamma, self.method, self.deed = gamma, method, deed

    def _do(self, method: str, made: Any) -> Any:
        return self.deed(made) if method == self.method else made

    @property
    def light_parameters(self) -> tuple[str, ...]:
        return self._do("light_parameters", ("gamma",))  # type: ignore[no-any-return]

    def check(self, *batches: Any) -> None:
        self._do("check", None)

    def shared(self, a: Any, b: Any = None) -> Any:
        return a @ (a if b is None else b).T

    def from_shared(self, shared: Any) -> Any:
        return self._do("from_shared", self.gamma * shared)

    def gram(self, a: Any, b: Any = None) -> Any:
        return self._do("gram", self.gamma * self.shared(a, b))


@pytest.mark.parametrize(
    ("method", "deed", "said"),
    [
        ("light_parameters", lambda _: raises(), "light_parameters failed: ValueError: two lines"),
        ("light_parameters", lambda _: 5, "light_parameters is an int, not a tuple of names"),
        ("check", lambda _: raises(), "check failed: ValueError: two lines"),
        ("from_shared", lambda _: raises(), "from_shared failed: ValueError: two lines"),
        ("from_shared", lambda _: {}, "from_shared returned a dict, not an array of floats"),
        ("from_shared", lambda g: g[:, 1:], r"from_shared returned an array of shape"),
        ("from_shared", lambda g: g * np.nan, "of these features is not finite"),
    ],
)
def test_a_kernel_that_misbehaves_in_a_search(method: str, deed: Deed, said: str) -> None:
    kernel = Odd(method=method, deed=deed)
    search = {"kernel__gamma": [0.1, 1.0]}
    who = rf"kernel Odd \({__name__}\):?"
    with pytest.raises(Exception, match=f"^{who} {said}"):
        fit(classifier=SVM(kernel=kernel, search=search))


class OddScaling(Scaling):
    """Makes something else of the features."""

    def __init__(self, deed: Deed = raises) -> None:
        self.deed = deed

    def fit(self, features: Any) -> OddScaling:
        return self

    def transform(self, features: Any) -> Any:
        return self.deed(features)


def test_a_scaling_that_returns_nan() -> None:
    said = rf"^scaling OddScaling \({__name__}\): transform returned NaN or infinite numbers"
    with pytest.raises(ContractError, match=said):
        fit(classifier=SVM(kernel=RBF(), scaling=OddScaling(lambda features: features * np.nan)))


class Uncopied(Beams):
    """Does something else where it is copied."""

    deed: Deed

    def __sklearn_clone__(self) -> Any:
        return self.deed()


@pytest.mark.parametrize(
    ("deed", "said"),
    [
        (raises, "failed: ValueError: two lines"),
        (lambda: None, "returned None, not an Uncopied"),
    ],
)
def test_a_component_that_cannot_be_copied(deed: Deed, said: str) -> None:
    cue = Uncopied()
    cue.deed = deed
    with pytest.raises(ComponentError, match=rf"^cue Uncopied \({__name__}\): clone {said}"):
        clone(cue)


# ---------------------------------------------------------------------- folds


class OddFolds(FoldScheme):
    """Cuts samples in an odd way."""

    def __init__(self, deed: Deed = raises) -> None:
        super().__init__()
        self.deed = deed

    def assign(self, labels: Any, stamps: Any = None, groups: Any = None) -> Any:
        raise NotImplementedError

    def split(self, labels: Any, stamps: Any = None, groups: Any = None) -> Any:
        return self.deed()


@pytest.mark.parametrize(
    ("deed", "said"),
    [
        (raises, "failed: ValueError: two lines"),
        (lambda: None, "failed: TypeError: 'NoneType' object is not iterable"),
        (lambda: [1, 2], "yielded an int, not training rows and held-out rows"),
        (lambda: [([0], [1])], "yielded a list as rows, not an array of whole numbers"),
        (lambda: [(np.arange(9), np.array([999]))], "yielded rows of which none, or not all, are"),
        (lambda: [(np.arange(9), np.arange(0))], "yielded rows of which none, or not all, are"),
        (lambda: [(np.arange(9), np.arange(9))], "yielded a fold that holds out samples which it"),
    ],
)
def test_folds_that_cut_badly(deed: Deed, said: str) -> None:
    classifier = SVM(kernel=RBF(), search={"C": [1.0, 10.0]})
    with pytest.raises(ComponentError, match=rf"^folds OddFolds \({__name__}\): split {said}"):
        fit(classifier=classifier, folds=OddFolds(deed))


# ---------------------------------------------------------------------- integrators


class OddIntegrator(Integrator):
    """Passes the first cue on, with one method that does something else."""

    def __init__(self, method: str = "", deed: Deed = raises) -> None:
        self.method, self.deed = method, deed

    def fit(self, evidence: Any, labels: Any, stamps: Any = None) -> OddIntegrator:
        return self

    def integrate(self, evidence: Any) -> Any:
        sound = evidence.scores(evidence.cues[0])
        return self.deed(sound) if self.method == "integrate" else sound

    def unfitted(self) -> Any:
        return self.deed(None) if self.method == "unfitted" else super().unfitted()


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize(
    ("method", "deed", "said"),
    [
        ("unfitted", lambda _: raises(), "unfitted failed: ValueError: two lines"),
        ("integrate", lambda _: raises(), "integrate failed: ValueError: two lines"),
        ("unfitted", lambda _: None, "unfitted returned None, not a copy of the integrator"),
        (
            "integrate",
            lambda made: Scores(made.values, OneAgainstAll(("a", "b", "c", "d"))),
            "integrate returned scores of a, b, c, d, not of corridor, kitchen, lab, office",
        ),
        ("integrate", lambda made: made[:1], "integrate returned 1 row for"),
        ("integrate", lambda made: made.values, "integrate returned a ndarray, not Scores"),
    ],
)
def test_an_integrator_that_misbehaves_where_it_is_judged(
    method: str, deed: Deed, said: str, apart: bool
) -> None:
    """On copies of the whole pipeline, and on another log alone."""
    integration = Walk(rounds=2, seed=1) if apart else None
    who = rf"integrator OddIntegrator \({__name__}\)"
    with pytest.raises(ComponentError, match=f"^{who}: {said}"):
        fit(
            integrator=OddIntegrator(method, deed),
            unknown=Unknown(false_accept_rate=0.05),
            integration=integration,
        )


def test_an_integrator_of_other_classes_classifies_nothing() -> None:
    made = Pipeline({"first": (Beams(), Means()), "second": (Beams(2), Means())}, OddIntegrator())
    made.fit(Walk(rounds=2))
    other = OneAgainstAll(("a", "b", "c", "d"))
    made.integrator = OddIntegrator("integrate", lambda scores: Scores(scores.values, other))
    who = rf"integrator OddIntegrator \({__name__}\)"
    with pytest.raises(ContractError, match=f"^{who}: integrate returned scores of a, b, c, d, no"):
        next(made.beliefs(Walk(rounds=1)))
