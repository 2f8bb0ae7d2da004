"""Colour histograms count L*, a*, b* as the CIE defines them."""

import numpy as np

from pictures import observe
from placecue_cues.color_histogram import ColorHistogram


def lab(rgb: tuple[int, int, int]) -> tuple[float, float, float]:
    """CIE L*a*b* under D65 of an sRGB colour, by the formulas."""
    c = np.array(rgb) / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    matrix = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    xyz = np.array(matrix) @ linear / [0.95047, 1.0, 1.08883]
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz * (29 / 6) ** 2 / 3 + 4 / 29)
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


def bin_of(rgb: tuple[int, int, int], bins: tuple[int, int, int], limit: float) -> int:
    level, a, b = lab(rgb)
    first = min(int(level / 100 * bins[0]), bins[0] - 1)
    second, third = (
        min(max(int((v + limit) / (2 * limit) * n), 0), n - 1)
        for v, n in ((a, bins[1]), (b, bins[2]))
    )
    return (first * bins[1] + second) * bins[2] + third


def test_two_colours() -> None:
    brick, sky = (178, 84, 60), (110, 160, 220)
    image = np.empty((10, 12, 3), np.uint8)
    image[:, :3], image[:, 3:] = brick, sky
    row = ColorHistogram((5, 7, 9), 60.0).features(observe(image))
    assert row.shape == (1, 5 * 7 * 9)
    wanted = np.zeros(5 * 7 * 9)
    wanted[bin_of(brick, (5, 7, 9), 60)] += 0.25
    wanted[bin_of(sky, (5, 7, 9), 60)] += 0.75
    np.testing.assert_allclose(row.toarray()[0], wanted, atol=1e-12)


def test_strong_colours_count_in_the_end_bins() -> None:
    blue = np.full((4, 4, 3), (0, 0, 255), np.uint8)
    row = ColorHistogram((8, 4, 4), 20.0).features(observe(blue))
    # L* 32, a* 79, b* -108.
    assert row.indices.tolist() == [(2 * 4 + 3) * 4 + 0]


def test_sums_to_one_and_forgets_place() -> None:
    image = np.random.default_rng(0).integers(0, 256, (40, 50, 3), dtype=np.uint8)
    row = ColorHistogram().features(observe(image))
    assert row.sum() == np.float64(1) or abs(row.sum() - 1) < 1e-12
    shuffled = np.random.default_rng(1).permutation(image.reshape(-1, 3)).reshape(image.shape)
    assert abs(row - ColorHistogram().features(observe(shuffled))).max() < 1e-12
