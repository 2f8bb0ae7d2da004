"""Sums and products of kernels equal sums and products of their Gram matrices."""

from pathlib import Path

import numpy as np
import pytest
from scipy import sparse
from sklearn.base import clone
from sklearn.metrics.pairwise import chi2_kernel, linear_kernel, rbf_kernel
from sklearn.svm import SVC

from placecue import DescriptorSets, UsageError
from placecue.components.build import build, describe
from placecue.components.manager import load_plugins
from placecue.components.pipelines import components_of
from placecue.storage.state import Decoder, Encoder
from placecue_classifiers.svm import SVM
from placecue_kernels.chi2 import Chi2
from placecue_kernels.combined import Combined, Product, Sum
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.match import Match
from placecue_kernels.rbf import RBF

REGISTRY = load_plugins(built_ins_only=True).registry


def histograms(n: int, seed: int) -> np.ndarray:
    values = np.random.default_rng(seed).random((n, 12))
    return values / values.sum(axis=1, keepdims=True)


def test_sum_and_product() -> None:
    x, y = histograms(7, 0), histograms(5, 1)
    chi2, rbf = chi2_kernel(x, y, gamma=2.0), rbf_kernel(x, y, gamma=3.0)
    kernels = [Chi2(2.0), RBF(3.0)]
    found = Sum(kernels, [0.5, 2]).gram(x, y)
    np.testing.assert_allclose(found, 0.5 * chi2 + 2 * rbf, atol=1e-12)
    np.testing.assert_allclose(Product(kernels).gram(x, y), chi2 * rbf, atol=1e-12)
    found = Product(kernels, [0.5, 2]).gram(x, y)
    np.testing.assert_allclose(found, np.sqrt(chi2) * rbf**2, atol=1e-12)


@pytest.mark.parametrize("kind", [Sum, Product])
def test_positive_semi_definite_where_its_kernels_are(kind: type[Combined]) -> None:
    kernel = kind([Chi2(), HistogramIntersection(), Linear()])
    gram = kernel.gram(sparse.csr_array(histograms(20, 2)))
    np.testing.assert_allclose(gram, gram.T, atol=1e-15)
    assert np.linalg.eigvalsh(gram).min() > -1e-10


def test_kernels_are_fitted_on_training_features() -> None:
    x = histograms(9, 3) - 0.1
    kernel = Sum([HistogramIntersection(), Linear()])
    fitted = kernel.fit(x)
    shifted = x - np.minimum(x.min(axis=0), 0)
    wanted = np.minimum(shifted[:, None], shifted).sum(axis=2) + linear_kernel(x)
    np.testing.assert_allclose(fitted.gram(x, x), wanted, atol=1e-12)
    assert not hasattr(kernel.kernels[0], "minimum_")


@pytest.mark.parametrize(
    ("kernel", "message"),
    [
        (Sum(), "sum needs kernels"),
        (Product([Linear()], [1, 2]), "product has 1 kernels and needs as many weights"),
        (Sum([Linear()], [-1]), "none negative"),
        (Sum([Linear(), Match()]), "Match takes set of local descriptors, got dense vector"),
    ],
)
def test_mistakes(kernel: Combined, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        kernel.gram(histograms(3, 0))


def test_a_search_varies_the_weights_and_the_parameters_inside() -> None:
    x, labels = histograms(40, 6), np.repeat(list("abcd"), 10)
    x[np.arange(40), np.repeat(range(4), 10)] += 0.1
    gammas, weights = [0.1, 5.0], [[1, 1], [1, 0]]
    tried = {"kernel__kernels__0__gamma": gammas, "kernel__weights": weights}
    kernel = Sum([Chi2(), Linear()])
    svm = SVM(kernel=kernel, search=tried).fit(x, labels)
    assert svm.search_["kernel__kernels__0__gamma"] == [0.1, 0.1, 5.0, 5.0]
    found = svm.chosen_["kernel__kernels__0__gamma"], svm.chosen_["kernel__weights"]
    alone = SVM(kernel=Sum([Chi2(found[0]), Linear()], found[1])).fit(x, labels)
    np.testing.assert_array_equal(svm.scores(x).values, alone.scores(x).values)
    assert len(set(svm.search_["balanced_accuracy"])) > 1
    assert kernel.kernels[0].gamma == Chi2().gamma
    with pytest.raises(ValueError, match="Sum has no 'kernels__x'; did you mean 'kernels'"):
        kernel.set_params(kernels__x=1)


class Counted(Chi2):
    """Counts its distances."""

    made = 0

    def shared(self, a, b=None):  # type: ignore[no-untyped-def]
        Counted.made += 1
        return super().shared(a, b)


@pytest.mark.parametrize("kind", [Sum, Product])
def test_distances_are_shared_by_weights_and_gammas_inside(kind: type[Combined]) -> None:
    x, labels = histograms(40, 6), np.repeat(list("abcd"), 10)
    kernel = kind([Counted(1.0), Sum([HistogramIntersection(shift=False), Counted(2.0)])])
    assert kernel.light_parameters == (
        "weights",
        "kernels__0__gamma",
        "kernels__1__weights",
        "kernels__1__kernels__1__gamma",
    )
    tried = {
        "kernel__weights": [[1, 1], [2, 1]],
        "kernel__kernels__0__gamma": [0.1, 5.0],
        "kernel__kernels__1__weights": [[1, 1], [0, 1]],
        "kernel__kernels__1__kernels__1__gamma": [0.5, 2.0, 8.0],
        "C": [1.0, 100.0],
    }
    Counted.made = 0
    svm = SVM(kernel=kernel, search=tried, probability="sigmoid").fit(x, labels)
    assert len(svm.search_["C"]) == 48
    assert Counted.made == 2
    chosen = {n.removeprefix("kernel__"): v for n, v in svm.chosen_.items() if n != "C"}
    fixed = clone(kernel).set_params(**chosen).fit(x)
    assert {name: svm.kernel_.get_params()[name] for name in chosen} == chosen
    np.testing.assert_array_equal(svm.kernel_.gram(x[:3], x), fixed.gram(x[:3], x))
    before = (kernel.weights, kernel.kernels[0].gamma, kernel.kernels[1].kernels[1].gamma)
    assert before == (None, 1.0, 2.0)


class Squared(Sum):
    """A kernel with a Gram matrix of its own."""

    def gram(self, a, b=None):  # type: ignore[no-untyped-def]
        return super().gram(a, b) ** 2


def test_a_gram_matrix_of_its_own_is_trained_on_and_asked() -> None:
    x, labels = histograms(40, 6), np.repeat(list("abcd"), 10)
    tried = {"kernel__kernels__0__gamma": [0.1, 5.0], "C": [1.0, 10.0]}
    for search in (None, tried):
        svm = SVM(Squared([Chi2(1.0), Linear()]), search=search).fit(x, labels)
        gamma = 1.0 if search is None else svm.chosen_["kernel__kernels__0__gamma"]
        gram = (chi2_kernel(x, gamma=gamma) + linear_kernel(x)) ** 2
        peer = SVC(kernel="precomputed", C=svm.C_, class_weight="balanced")
        peer.fit(gram, labels == "a")
        found = svm.scores(x).values[:, 0]
        np.testing.assert_allclose(found, peer.decision_function(gram), atol=1e-2)


def test_where_nothing_light_is_searched_nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Chi2, "shared", None)
    monkeypatch.setattr(Chi2, "gram", lambda self, a, b=None: chi2_kernel(a, b, self.gamma))
    x, labels = histograms(40, 6), np.repeat(list("abcd"), 10)
    for kernel in (Chi2(), Sum([Chi2(), Linear()])):
        svm = SVM(kernel, search={"C": [1.0, 10.0]}, probability="sigmoid").fit(x, labels)
        np.testing.assert_allclose(svm.scores(x).values.sum(axis=1), 1)


@pytest.mark.parametrize("wrong", [-1.0, 0.0, "a"])
def test_gammas_inside_are_checked(wrong: object) -> None:
    x, labels = histograms(40, 6), np.repeat(list("abcd"), 10)
    svm = SVM(Sum([Chi2()]), search={"kernel__kernels__0__gamma": [1.0, wrong]})
    with pytest.raises(UsageError, match="kernels__0__gamma must list values above 0"):
        svm.fit(x, labels)


def test_searched_weights_stand_for_those_given() -> None:
    x, labels = histograms(40, 6), np.repeat(list("abcd"), 10)
    kernel = Sum([Chi2(), Linear()], [1])
    assert SVM(kernel, search={"kernel__weights": [[1, 1]]}).fit(x, labels).kernel_.weights == [
        1,
        1,
    ]
    with pytest.raises(UsageError, match="needs as many weights"):
        SVM(kernel).fit(x, labels)


def test_descriptor_sets_can_be_summed_over() -> None:
    sets = DescriptorSets(np.eye(4, dtype=np.float32), np.array([0, 2, 4]))
    found = Sum([Match(1.0), Match(0.5)]).gram(sets)
    other = np.exp(-2.0) + np.exp(-1.0)
    np.testing.assert_allclose(found, [[2, other], [other, 2]], atol=1e-6)


def test_configs_and_cloning() -> None:
    spec = {
        "plugin": "product",
        "kernels": [{"plugin": "chi2", "gamma": 0.5}, {"plugin": "hi", "shift": True}],
        "weights": None,
    }
    kernel = build(spec, "kernel", REGISTRY)
    assert isinstance(kernel.kernels[0], Chi2)
    assert describe(kernel, REGISTRY) == spec
    assert describe(clone(kernel), REGISTRY) == spec
    wrong = {"plugin": "sum", "kernels": [{"plugin": "chi3"}]}
    with pytest.raises(UsageError, match="unknown kernel 'chi3'; did you mean 'chi2'"):
        build(wrong, "kernel", REGISTRY)
    with pytest.raises(UsageError, match="kernels must be a list of kernel"):
        build({"plugin": "sum", "kernels": [1, 2]}, "kernel", REGISTRY)


def test_a_trained_model_is_stored_and_read(tmp_path: Path) -> None:
    x, labels = histograms(40, 4) - 0.1, np.repeat(list("abcd"), 10)
    model = SVM(kernel=Sum([HistogramIntersection(), RBF(5.0)])).fit(x, labels)
    encoder = Encoder(REGISTRY)
    state = encoder.state(model, "svm")
    again = clone(model)
    Decoder(REGISTRY, encoder.arrays).restore(again, state)
    np.testing.assert_array_equal(again.scores(x).values, model.scores(x).values)


def test_a_model_folder_names_the_kernels_inside() -> None:
    classifier = {"plugin": "svm", "kernel": {"plugin": "sum", "kernels": [{"plugin": "hi"}]}}
    spec = {"plugin": "gist", "classifier": classifier}
    composition = {"cues": {"gist": spec}, "integrator": None, "folds": "blocks"}
    named = set(components_of(composition, REGISTRY))
    wanted = {("cue", "gist"), ("classifier", "svm"), ("kernel", "sum"), ("kernel", "hi")}
    wanted |= {("folds", "blocks")}
    assert named == wanted
