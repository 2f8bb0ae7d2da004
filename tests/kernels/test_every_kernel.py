"""What every kernel owes: features of the right kind or a clear error, and what it claims to be."""

import numpy as np
import pytest
from scipy import sparse

from placecue import DataError, DescriptorSets, FeatureBatch, FeatureParts, Kernel, UsageError
from placecue_kernels.chi2 import Chi2
from placecue_kernels.combined import Product, Sum
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.match import Match
from placecue_kernels.parts import Parts
from placecue_kernels.rbf import RBF

KINDS = ("dense vector", "sparse histogram", "set of local descriptors", "features in parts")
VECTORS = KINDS[:2]
JOINED = (*VECTORS, KINDS[3])
TAKES = [
    (Chi2(), VECTORS),
    (HistogramIntersection(), JOINED),
    (Linear(), JOINED),
    (RBF(), JOINED),
    (Match(), KINDS[2:3]),
    (Sum([Chi2(), Linear()]), VECTORS),
    (Sum([Chi2(), RBF()]), VECTORS),
    (Sum([Match(), Match(0.3)]), KINDS[2:3]),
    (Product([HistogramIntersection(), RBF()]), JOINED),
    (Parts({"one": Chi2(), "other": RBF()}, join="product"), KINDS[3:]),
    (Product([Match(), Linear()]), ()),
]
EVERY = [kernel for kernel, _ in TAKES]


def name(kernel: Kernel) -> str:
    inner = getattr(kernel, "kernels", [])
    inner = inner.values() if isinstance(inner, dict) else inner
    return "-".join(type(each).__name__ for each in (kernel, *inner))


def batch(kind: str, n: int = 24, spoilt: float | None = None) -> FeatureBatch:
    values = np.random.default_rng(n).random((n, 8)).astype(np.float64)
    if spoilt is not None:
        values[3, [2, 6]] = spoilt
    if kind == "sparse histogram":
        return sparse.csr_array(values)
    if kind == "set of local descriptors":
        return DescriptorSets(values.astype(np.float32), np.arange(0, n + 1, 4))
    if kind == "features in parts":
        return FeatureParts({"one": sparse.csr_array(values[:, :5]), "other": values[:, 5:]})
    return values


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("kernel", "takes"), TAKES, ids=map(name, EVERY))
def test_a_kernel_takes_what_it_says(kernel: Kernel, takes: tuple[str, ...], kind: str) -> None:
    features = batch(kind)
    assert {str(each) for each in kernel.accepts} == set(takes)
    if kind in takes:
        gram = kernel.fit(features).gram(features)
        assert gram.shape == (features.shape[0],) * 2
        assert np.isfinite(gram).all()
        return
    for asked in (lambda: kernel.gram(features), lambda: kernel.check(features)):
        with pytest.raises(UsageError, match=f"takes .*, got {kind}: choose another kernel"):
            asked()


@pytest.mark.parametrize("kernel", EVERY[:10], ids=name)
def test_nan_is_no_feature(kernel: Kernel) -> None:
    kind = max(kernel.accepts)
    wrong, good = batch(kind, spoilt=np.nan), batch(kind, 16)
    for batches in ((wrong, None), (good, wrong), (wrong, good)):
        with pytest.raises(DataError, match=r"NaN|value nan"):
            kernel.gram(*batches)


@pytest.mark.parametrize("kernel", [each for each in EVERY if each.positive_definite], ids=name)
def test_positive_semi_definite_where_it_is_claimed(kernel: Kernel) -> None:
    for kind in kernel.accepts:
        gram = kernel.gram(batch(kind, 40))
        np.testing.assert_allclose(gram, gram.T, rtol=0, atol=1e-12)
        assert np.linalg.eigvalsh(gram).min() > -1e-9


def test_what_is_claimed() -> None:
    claims = [kernel.positive_definite for kernel in EVERY]
    assert claims == [True, True, True, True, False, True, True, False, True, True, False]
    # A square root of a kernel is one where it only halves gamma.
    assert Product([Chi2(), RBF()], [0.5, 1.5]).positive_definite
    assert Product([Linear()], [2]).positive_definite
    assert not Product([HistogramIntersection()], [0.5]).positive_definite


def test_a_match_kernel_need_not_be_positive_semi_definite() -> None:
    least = []
    for seed in range(30):
        values = np.random.default_rng(seed).random((24, 2)).astype(np.float32)
        sets = DescriptorSets(values, np.arange(0, 25, 3))
        least.append(np.linalg.eigvalsh(Match(5.0).gram(sets)).min())
    assert min(least) < -1e-3
