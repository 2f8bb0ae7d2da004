"""The features of the papers, for any field of view and any number of beams."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .beams import Beams
from .families import Family, numbered
from .marks import line_share, nearest_minima
from .moments import shape_moments
from .summaries import Matrix, above, below, kurtosis, mean_std, ratio


@dataclass(frozen=True, slots=True)
class FullFeatures:
    """What the papers leave open; the parameters of the same names of ``LaserGeometry``."""

    clips: Sequence[float]
    gaps: Sequence[float]
    relative_gaps: Sequence[float]
    fourier: int
    line_tolerance: float
    line_beams: int
    minima_depth: float
    hu_floor: float
    field_of_view: bool = False

    def families(self) -> tuple[Family, ...]:
        """Return the features: first of the beams, then of the polygon."""
        return (
            *self._range_families(),
            *self._pair_families(),
            *self._mark_families(),
            *_size_families(),
            *self._fourier_families(),
            *self._moment_families(),
            *((_FIELD_OF_VIEW,) if self.field_of_view else ()),
        )

    def _range_families(self) -> tuple[Family, ...]:
        return (
            Family(
                "differences",
                _mean_std_names("difference", self.clips),
                "m",
                "mean and standard deviation of the difference in range of neighbouring beams; "
                "also with ranges clipped at so many metres",
                self._differences,
            ),
            Family(
                "ranges",
                _mean_std_names("range", self.clips),
                "m",
                "mean and standard deviation of the range; also with ranges clipped",
                self._ranges,
            ),
            Family(
                "kurtosis",
                ("range_kurtosis",),
                "1",
                "kurtosis of the range, m4 / std⁴ (not the excess)",
                lambda beams: kurtosis(beams.ranges),
            ),
        )

    def _pair_families(self) -> tuple[Family, ...]:
        return (
            Family(
                "gaps",
                numbered("gaps", self.gaps),
                "1",
                "pairs of neighbouring beams that differ by more than so many metres, per beam",
                self._gaps,
            ),
            Family(
                "relative_gaps",
                numbered("relative_gaps", self.relative_gaps),
                "1",
                "pairs of neighbouring beams whose ratio, smaller over larger, is below so much, "
                "per beam",
                self._relative_gaps,
            ),
            Family(
                "ratios",
                ("ratio_mean", "ratio_std"),
                "1",
                "mean and standard deviation of that ratio",
                lambda beams: mean_std(beams.ratios()),
            ),
        )

    def _mark_families(self) -> tuple[Family, ...]:
        return (
            Family(
                "lines",
                ("line_share",),
                "1",
                "share of the beams that lie on straight lines (split and merge)",
                self._line_share,
            ),
            Family(
                "minima",
                ("minima_distance",),
                "m",
                "distance between the end points of the two smallest local minima of the range; "
                "0 where there are not two",
                lambda beams: self._minima(beams)[:, :1],
            ),
            Family(
                "minima",
                ("minima_angle",),
                "rad",
                "angle between these two beams, 0 to π",
                lambda beams: self._minima(beams)[:, 1:],
            ),
        )

    def _fourier_families(self) -> tuple[Family, ...]:
        return (
            Family(
                "fourier",
                numbered("fourier", self._orders()),
                "1",
                "Fourier descriptors of the boundary by arc length: abs(c_k) / abs(c_1)",
                self._fourier,
            ),
            Family(
                "ellipse",
                ("ellipse_major", "ellipse_minor"),
                "m",
                "half axes of the ellipse of c_1 and c_-1: abs(c_1) + abs(c_-1), "
                "abs(abs(c_1) - abs(c_-1))",
                lambda beams: np.hstack(beams.harmonics(self._count, self._count).axes),
            ),
            Family("ellipse", ("ellipse_ratio",), "1", "minor over major", self._ellipse_ratio),
        )

    def _moment_families(self) -> tuple[Family, ...]:
        return (
            Family(
                "moments",
                (*numbered("hu", range(1, 8)), "compactness", "eccentricity"),
                "1",
                f"Hu's moments of the polygon, sign(h) · log10(1 + abs(h) / {self.hu_floor:g}); "
                "normalised compactness, area² / (2π(μ20 + μ02)); normalised eccentricity, "
                "sqrt((μ20 - μ02)² + 4μ11²) / (μ20 + μ02)",
                lambda beams: shape_moments(beams.polygons, self.hu_floor),
            ),
            Family("form_factor", ("form_factor",), "1", "4π · area / perimeter²", _form_factor),
        )

    def _differences(self, beams: Beams) -> Matrix:
        return np.hstack([mean_std(beams.differences(clip)) for clip in (np.inf, *self.clips)])

    def _ranges(self, beams: Beams) -> Matrix:
        clips = (np.inf, *self.clips)
        return np.hstack([mean_std(np.minimum(beams.ranges, clip)) for clip in clips])

    def _gaps(self, beams: Beams) -> Matrix:
        return above(beams.differences(), self.gaps) / beams.count

    def _relative_gaps(self, beams: Beams) -> Matrix:
        return below(beams.ratios(), self.relative_gaps) / beams.count

    def _line_share(self, beams: Beams) -> Matrix:
        share = [line_share(row, self.line_tolerance, self.line_beams) for row in beams.points]
        return np.array(share)[:, None]

    def _minima(self, beams: Beams) -> Matrix:
        """Return distance (m) and angle (rad) between the two smallest minima, shape (n, 2)."""
        found = np.zeros((len(beams.ranges), 2))
        for row, ranges in enumerate(beams.ranges):
            minima = nearest_minima(ranges, beams.cyclic, self.minima_depth)
            if len(minima):
                first, second = beams.points[row, minima]
                turn = np.exp(1j * (beams.angles[minima[0]] - beams.angles[minima[1]]))
                found[row] = np.abs(first - second), np.abs(np.angle(turn))
        return found

    @property
    def _count(self) -> int:
        return self.fourier // 2 + 1

    def _orders(self) -> list[int]:
        """Return -1, 2, -2, 3, -3 ..., as many as asked for: c_1 is what they are divided by."""
        return [sign * k for k in range(1, self._count + 1) for sign in (1, -1)][1:][: self.fourier]

    def _fourier(self, beams: Beams) -> Matrix:
        positive, negative = beams.harmonics(self._count, self._count).scaled
        alternating = np.stack([positive, negative], axis=2).reshape(len(positive), -1)
        return alternating[:, 1 : 1 + self.fourier]

    def _ellipse_ratio(self, beams: Beams) -> Matrix:
        major, minor = beams.harmonics(self._count, self._count).axes
        return ratio(minor, major)


def _size_families() -> tuple[Family, ...]:
    return (
        Family("size", ("area",), "m²", "area of the polygon", lambda beams: beams.polygons.area),
        Family("size", ("perimeter",), "m", "perimeter", lambda beams: beams.polygons.perimeter),
        Family(
            "size",
            ("area_per_perimeter",),
            "m",
            "area / perimeter",
            lambda beams: ratio(beams.polygons.area, beams.polygons.perimeter),
        ),
        Family(
            "boundary",
            ("boundary_mean", "boundary_std"),
            "m",
            "mean and standard deviation of the distance from the centroid to the boundary",
            lambda beams: beams.polygons.boundary_distance(),
        ),
        Family(
            "boundary",
            ("boundary_mean_scaled", "boundary_std_scaled"),
            "1",
            "the same, divided by the largest distance",
            _scaled_boundary,
        ),
    )


def _covered(beams: Beams) -> Matrix:
    full = 2 * np.pi if beams.cyclic else beams.angles[-1] - beams.angles[0]
    return np.full((len(beams.ranges), 1), full)


_FIELD_OF_VIEW = Family(
    "field_of_view", ("field_of_view",), "rad", "angle from the first beam to the last", _covered
)


def _mean_std_names(name: str, clips: Sequence[float]) -> tuple[str, ...]:
    ends = ("", *(f"(clip={clip:g})" for clip in clips))
    return tuple(f"{name}_{part}{end}" for end in ends for part in ("mean", "std"))


def _scaled_boundary(beams: Beams) -> Matrix:
    largest = beams.polygons.spokes.max(axis=1, keepdims=True)
    return ratio(beams.polygons.boundary_distance(), largest)


def _form_factor(beams: Beams) -> Matrix:
    return ratio(4 * np.pi * beams.polygons.area, beams.polygons.perimeter**2)
