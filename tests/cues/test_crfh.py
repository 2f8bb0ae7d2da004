"""CRFH agrees with the histograms of the group's own code, and with a plain definition."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage, sparse
from sklearn.base import clone

from placecue import Observation, UnusableObservation, UsageError
from placecue_cues.crfh import CRFH

DATA = Path(__file__).parents[1] / "data" / "crfh"
LISTS = {
    "t4_t64": ("Lxx@4", "Lxy@4", "Lyy@4", "Lxx@64", "Lxy@64", "Lyy@64"),
    "t8_t2": ("Lxx@8", "Lxy@8", "Lyy@8", "Lxx@2", "Lxy@2", "Lyy@2"),
}
CHANNELS = {"meanrgb": "mean", "hls": "hls"}


def observe(image: np.ndarray) -> Observation:
    return Observation(0, image=image)


def load(folder: Path, name: str) -> Observation:
    return observe(cv2.cvtColor(cv2.imread(str(folder / f"{name}.png")), cv2.COLOR_BGR2RGB))


def expected(folder: Path, name: str, which: str, channel: str) -> sparse.csr_array:
    with np.load(folder / f"{name}.npz") as data:
        keys, counts = data[f"{which}_{channel}_key"], data[f"{which}_{channel}_count"]
        values = counts / data["sum"]
    return sparse.csr_array((values, keys, [0, len(keys)]), shape=(1, 28**6))


def compare(a: sparse.csr_array, b: sparse.csr_array) -> tuple[float, float]:
    """Return histogram intersection and chi-squared distance."""
    columns = np.union1d(a.indices, b.indices)
    x, y = (np.zeros(len(columns)) for _ in range(2))
    x[np.searchsorted(columns, a.indices)] = a.data
    y[np.searchsorted(columns, b.indices)] = b.data
    return float(np.minimum(x, y).sum()), float(((x - y) ** 2 / (x + y)).sum())


def check_identical(folder: Path, name: str, which: str, channel: str) -> None:
    row = CRFH(LISTS[which], channel=CHANNELS[channel]).extract(load(folder, name))
    wanted = expected(folder, name, which, channel)
    np.testing.assert_array_equal(row.indices, wanted.indices)
    np.testing.assert_array_equal(row.data, wanted.data)


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize("which", LISTS)
@pytest.mark.parametrize("name", ["camera", "astronaut"])
def test_photographs_are_identical_in_double(name: str, which: str, channel: str) -> None:
    check_identical(DATA, name, which, channel)


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize("which", LISTS)
def test_third_photograph_is_identical(reference: Path, which: str, channel: str) -> None:
    check_identical(reference / "crfh", "motorcycle", which, channel)


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize("which", LISTS)
@pytest.mark.parametrize(
    ("name", "precision", "intersection", "chi2"),
    [
        ("camera", "single", 0.998, 1e-3),
        ("astronaut", "single", 0.998, 1e-3),
        ("synthetic", "single", 0.99, np.inf),
        ("synthetic", "double", 0.99, np.inf),
    ],
)
def test_agreement_where_rounding_decides(
    name: str, precision: str, intersection: float, chi2: float, which: str, channel: str
) -> None:
    cue = CRFH(LISTS[which], channel=CHANNELS[channel], precision=precision)
    found = compare(cue.extract(load(DATA, name)), expected(DATA, name, which, channel))
    assert found[0] >= intersection
    assert found[1] <= chi2


def test_row_is_a_normalised_histogram() -> None:
    row = CRFH().features(load(DATA, "camera"))
    assert row.shape == (1, 28**6)
    assert row.data.dtype == np.float64
    assert row.has_canonical_format
    assert row.sum() == pytest.approx(1, abs=1e-12)


def by_definition(grey: np.ndarray, border: int, bins: int) -> np.ndarray:
    """L, Lx, Ly and Lxy at t = 2 with SciPy, counted one pixel at a time."""
    reach = np.arange(-5, 6)
    taps = np.exp(-(reach**2) / 4.0)
    taps /= taps.sum()
    smooth = ndimage.correlate1d(grey.astype(float), taps, axis=0, mode="constant")
    smooth = ndimage.correlate1d(smooth, taps, axis=1, mode="constant")
    dx = ndimage.correlate1d(smooth, [-0.5, 0, 0.5], axis=1, mode="constant")
    dy = ndimage.correlate1d(smooth, [-0.5, 0, 0.5], axis=0, mode="constant")
    dxy = ndimage.correlate1d(dx, [-0.5, 0, 0.5], axis=0, mode="constant")
    counts = np.zeros(bins**4)
    root = np.sqrt(2.0)
    height, width = grey.shape
    for y in range(border, height - border):
        for x in range(border, width - border):
            level = int(smooth[y, x] * bins / 255)
            rest = [int((v[y, x] + 128) * bins / 256) for v in (dx * root, dy * root, dxy * 2)]
            digits = [min(max(b, 0), bins - 1) for b in (level, *rest)]
            counts[sum(d * bins**i for i, d in enumerate(digits))] += 1
    return counts / counts.sum()


@pytest.mark.parametrize("border", [0, 3])
def test_first_order_and_smoothed_image_by_definition(border: int) -> None:
    grey = np.random.default_rng(5).integers(0, 256, (24, 30), dtype=np.uint8)
    cue = CRFH(["L@2", "Lx@2", "Ly@2", "Lxy@2"], bins=7, border=border)
    row = cue.extract(observe(grey)).toarray()[0]
    np.testing.assert_allclose(row, by_definition(grey, border, 7), atol=1e-12)


def test_grey_colour_and_sixteen_bits_agree() -> None:
    grey = cv2.cvtColor(load(DATA, "camera").image, cv2.COLOR_RGB2GRAY)
    wanted = CRFH().extract(observe(grey))
    colour = np.repeat(grey[:, :, None], 3, axis=2)
    for image, channel in (
        (colour, "mean"),
        (colour, "hls"),
        (grey.astype(np.uint16) * 257, "hls"),
    ):
        row = CRFH(channel=channel).extract(observe(image))
        np.testing.assert_array_equal(row.indices, wanted.indices)
        np.testing.assert_array_equal(row.data, wanted.data)


def test_threshold_drops_small_bins_without_renormalising() -> None:
    full, kept = (CRFH(threshold=t).extract(load(DATA, "astronaut")) for t in (0.0, 1e-4))
    large = full.data >= 1e-4
    np.testing.assert_array_equal(kept.indices, full.indices[large])
    np.testing.assert_array_equal(kept.data, full.data[large])
    assert kept.sum() < 1


def test_long_lists_take_64_bit_keys() -> None:
    cue = CRFH([f"{name}@{t}" for t in (2, 8, 32) for name in ("Lxx", "Lxy", "Lyy")])
    batch = cue.transform([load(DATA, name) for name in ("camera", "astronaut")])
    assert batch.shape == (2, 28**9)
    np.testing.assert_allclose(batch.sum(axis=1), 1)
    # The first six digits alone are the histogram of the first six descriptors.
    six = CRFH(cue.descriptors[:6]).extract(load(DATA, "camera"))
    short = np.unique(batch[[0]].indices % 28**6)
    np.testing.assert_array_equal(short, six.indices)


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 4), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_shape_and_sum(n: int, bins: int, seed: int) -> None:
    image = np.random.default_rng(seed).integers(0, 256, (40, 37, 3), dtype=np.uint8)
    row = CRFH([f"Lxx@{2**i}" for i in range(n)], bins=bins).extract(observe(image))
    assert row.shape == (1, bins**n)
    assert row.sum() == pytest.approx(1)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"descriptors": []}, "at least one descriptor"),
        ({"descriptors": ["Lxx"]}, "NAME@SCALE"),
        ({"descriptors": ["Lxx@0"]}, "scale above 0"),
        ({"descriptors": ["Lxxx@4"]}, "did you mean 'Lxx'"),
        ({"descriptors": ["Lxx@4"] * 14}, "64-bit"),
        ({"channel": "men"}, "did you mean 'mean'"),
        ({"precision": "half"}, "double, single"),
        ({"bins": 0}, "bins >= 1"),
        ({"border": -1}, "border >= 0"),
        ({"derivative_limit": 0.0}, "derivative_limit > 0"),
    ],
)
def test_wrong_parameters(parameters: dict[str, object], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        CRFH(**parameters).extract(observe(np.zeros((50, 50), np.uint8)))


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.zeros((30, 200, 3), np.uint8), "200x30 pixels"),
        (np.zeros((0, 0), np.uint8), "0x0 pixels"),
        (np.zeros((50, 50)), "float64"),
        (np.zeros((50, 50, 4), np.uint8), r"\(50, 50, 4\)"),
    ],
)
def test_unusable_images(image: np.ndarray, message: str) -> None:
    with pytest.raises(UnusableObservation, match=message):
        CRFH().extract(observe(image))


def test_missing_image() -> None:
    with pytest.raises(UnusableObservation, match="no image at stamp 0"):
        CRFH().features(Observation(0))


def test_parameters_survive_cloning() -> None:
    cue = CRFH(["Lx@2"], bins=9, precision="single")
    assert clone(cue).get_params() == cue.get_params()
