"""The 182 features of the paper's group, in its order and under its names.

Pairs are cyclic, the polygon's vertices are the end points alone, and nothing is clipped.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from .beams import Beams
from .families import Family, numbered
from .summaries import Matrix, above, below, kurtosis, mean_std, ratio

#: Added to ranges before they are divided by one another, m.
EPSILON = 1e-4
GAPS = [step / 2 for step in range(1, 21)]
RELATIVE_GAPS = [step / 10 for step in range(1, 11)]
#: Highest Fourier coefficient, and how many with a negative index: c_-1 alone.
HARMONICS = 100, 1


@cache
def families() -> tuple[Family, ...]:
    """Return the features in the group's order."""
    return (*_ranges_and_polygon(), *_fourier(), *_ratios(), *_counts())


def _ranges_and_polygon() -> tuple[Family, ...]:
    return (
        Family(
            "differences",
            ("f2", "f2_sd"),
            "m",
            "mean and standard deviation of abs(r_i - r_next)",
            lambda beams: mean_std(beams.differences()),
        ),
        Family(
            "size", ("f5",), "m²", "signed area of the polygon", lambda beams: beams.polygons.area
        ),
        Family("size", ("f6",), "m", "perimeter", lambda beams: beams.polygons.perimeter),
        Family("size", ("f7",), "1/m", "perimeter / area", _perimeter_per_area),
        Family(
            "ranges",
            ("f8", "f8_sd"),
            "m",
            "mean and standard deviation of r",
            lambda beams: mean_std(beams.ranges),
        ),
        Family(
            "boundary",
            ("f9", "f9_sd"),
            "m",
            "mean and standard deviation of D, the distance from the centroid to the end points",
            lambda beams: mean_std(beams.polygons.spokes),
        ),
        Family(
            "gaps",
            numbered("f14", GAPS),
            "count",
            "number of pairs with abs(r_i - r_next) above so many metres",
            _gaps,
        ),
    )


def _fourier() -> tuple[Family, ...]:
    return (
        Family(
            "fourier",
            numbered("f16", range(2, HARMONICS[0] + 1)),
            "1",
            "abs(c_k) / abs(c_1), c_k the Fourier coefficients of the polygon by arc length",
            lambda beams: beams.harmonics(*HARMONICS).scaled[0][:, 1:],
        ),
        Family(
            "ellipse",
            ("f17", "f18"),
            "m",
            "major and minor axis, abs(c_1) + abs(c_-1) and abs(abs(c_1) - abs(c_-1))",
            lambda beams: np.hstack(beams.harmonics(*HARMONICS).axes),
        ),
        Family("ellipse", ("f19",), "1", "f18 / f17", _axes_ratio),
        Family("ellipse", ("f17_2", "f18_2"), "1", "f17 and f18 divided by abs(c_1)", _scaled_axes),
        Family("ellipse", ("f19_2",), "1", "f18_2 / f17_2, which is f19 again", _axes_ratio),
    )


def _ratios() -> tuple[Family, ...]:
    return (
        Family(
            "ratios",
            ("f27", "f27_sd"),
            "1",
            "mean and standard deviation of q, the smaller over the larger of r_i + 0.0001 and "
            "r_next + 0.0001",
            lambda beams: mean_std(beams.ratios(EPSILON)),
        ),
        Family(
            "ranges",
            ("f28", "f28_sd"),
            "1",
            "mean and standard deviation of (r + 0.0001) / max(r + 0.0001)",
            _relative_ranges,
        ),
        Family(
            "boundary",
            ("f29", "f29_sd"),
            "1",
            "mean(D) / max(D) + 0.0001, and sqrt(mean((D / max(D) - f29)²))",
            _relative_spokes,
        ),
        Family(
            "relative_gaps",
            numbered("f30", RELATIVE_GAPS, ".1f"),
            "count",
            "number of pairs with q below so much",
            _relative_gaps,
        ),
    )


def _counts() -> tuple[Family, ...]:
    return (
        Family("form_factor", ("f31",), "1", "4π · area / perimeter²", _form_factor),
        Family(
            "kurtosis",
            ("f32",),
            "1",
            "kurtosis of r, m4 / std⁴ (not the excess)",
            lambda beams: kurtosis(beams.ranges),
        ),
        Family(
            "gaps",
            numbered("f33", GAPS),
            "1",
            "f14 / (n - 1), n the number of beams",
            lambda beams: _gaps(beams) / max(beams.count - 1, 1),
        ),
        Family(
            "relative_gaps",
            numbered("f34", RELATIVE_GAPS, ".1f"),
            "1",
            "f30 / (n - 1)",
            lambda beams: _relative_gaps(beams) / max(beams.count - 1, 1),
        ),
    )


def _perimeter_per_area(beams: Beams) -> Matrix:
    polygons = beams.polygons
    return ratio(polygons.perimeter, polygons.area, polygons.least_area)


def _form_factor(beams: Beams) -> Matrix:
    return ratio(4 * np.pi * beams.polygons.area, beams.polygons.perimeter**2)


def _gaps(beams: Beams) -> Matrix:
    return above(beams.differences(), GAPS)


def _relative_gaps(beams: Beams) -> Matrix:
    return below(beams.ratios(EPSILON), RELATIVE_GAPS)


def _axes_ratio(beams: Beams) -> Matrix:
    major, minor = beams.harmonics(*HARMONICS).axes
    return ratio(minor, major)


def _scaled_axes(beams: Beams) -> Matrix:
    magnitudes = beams.harmonics(*HARMONICS)
    return ratio(np.hstack(magnitudes.axes), magnitudes.first)


def _relative_ranges(beams: Beams) -> Matrix:
    shifted = beams.ranges + EPSILON
    return mean_std(ratio(shifted, shifted.max(axis=1, keepdims=True)))


def _relative_spokes(beams: Beams) -> Matrix:
    spokes = beams.polygons.spokes
    shares = ratio(spokes, spokes.max(axis=1, keepdims=True))
    mean = shares.mean(axis=1, keepdims=True) + EPSILON
    return np.hstack([mean, np.sqrt(np.mean((shares - mean) ** 2, axis=1, keepdims=True))])
