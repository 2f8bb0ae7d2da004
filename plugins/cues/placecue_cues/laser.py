"""Geometric features of 2D laser scans."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import groupby
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue.checks import check_flag
from placecue.cue import Augmentation, Cue
from placecue.errors import UnusableObservation, UsageError, choices
from placecue.features import FeatureBatch, stack
from placecue.observation import LaserScan, Observation, Part

from .scan import group
from .scan.beams import Beams
from .scan.families import Family, evaluate
from .scan.full import FullFeatures
from .scan.resample import resample

PRESETS = ("group", "full")
#: Scans computed at a time: enough to spread the cost of a call, few enough for the cache.
_BATCH = 8


class LaserGeometry(Cue):
    """Single-valued geometric features of a laser scan, as a vector of shape (d,).

    Invalid beams count as the scanner's maximum range. Degenerate scans give finite numbers: a
    ratio to nothing is 0. What each feature is, and its unit, stands in ``docs/laser_features.md``.

    Parameters
    ----------
    preset : {"group", "full"}
        ``group``: the 182 features that the paper's group used, made for 180 degrees a scanner,
        with cyclic pairs and ranges in single precision, as in its code; they depend on the
        number of beams. ``full``: every feature of the papers, for any field of view; scans are
        first resampled to a fixed angular step. The parameters below are for ``full``.
    angular_step : float
        Angle between resampled beams, degrees.
    grazing_angle : float
        Neighbouring beams are on one surface if it is inclined to them by more, degrees;
        otherwise the range jumps from one to the other.
    clips : sequence of float
        Ranges at which differences and ranges are clipped for further copies of their mean and
        standard deviation, m.
    gaps : sequence of float
        Differences between neighbouring beams that count as a gap, m.
    relative_gaps : sequence of float
        Ratios of neighbouring beams below which there is a relative gap.
    fourier : int
        Number of Fourier descriptors.
    line_tolerance : float
        Largest distance of a point from the line it is on, m.
    line_beams : int
        Fewest resampled beams on a line.
    minima_depth : float
        How far the range must rise on both sides of a local minimum, m; noise makes many smaller
        ones. At the end of a scan of less than a full turn there is one side only.
    hu_floor : float
        Hu's moments below this are on a linear scale, above on a logarithmic one.
    scales : sequence of float
        Training also sees every scan with its ranges times each of these, such as 0.8 and 1.25:
        rooms of another building are of other sizes. 1 is always among them.
    field_of_view : bool
        Add the angle that the scan covers to the features, so that one model can tell scans of
        several scanners apart.

    References
    ----------
    Martinez Mozos, Stachniss and Burgard, Supervised learning of places from range data using
    AdaBoost, ICRA 2005. Martinez Mozos et al., Supervised semantic labeling of places using
    information extracted from sensor data, RAS 55(5), 2007.
    """

    requires: ClassVar[tuple[Part, ...]] = ("scan",)
    # 2: minima of the preset full may lie at the ends of a scan.
    version: ClassVar[str] = "2"

    def __init__(
        self,
        preset: str = "group",
        angular_step: float = 0.5,
        grazing_angle: float = 5.0,
        clips: Sequence[float] = (2.0, 5.0, 10.0, 20.0, 50.0),
        gaps: Sequence[float] = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.5, 10.0),
        relative_gaps: Sequence[float] = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9),
        fourier: int = 16,
        line_tolerance: float = 0.05,
        line_beams: int = 8,
        minima_depth: float = 0.1,
        hu_floor: float = 1e-7,
        scales: Sequence[float] = (1.0,),
        field_of_view: bool = False,
    ) -> None:
        self.preset = preset
        self.angular_step = angular_step
        self.grazing_angle = grazing_angle
        self.clips = clips
        self.gaps = gaps
        self.relative_gaps = relative_gaps
        self.fourier = fourier
        self.line_tolerance = line_tolerance
        self.line_beams = line_beams
        self.minima_depth = minima_depth
        self.hu_floor = hu_floor
        self.scales = scales
        self.field_of_view = field_of_view

    @property
    def feature_names(self) -> list[str]:
        """The names of the d features."""
        return [name for family in self.feature_families() for name in family.names]

    @property
    def feature_units(self) -> list[str]:
        """The units of the d features; ``1`` for pure numbers."""
        return [family.unit for family in self.feature_families() for _ in family.names]

    @property
    def families(self) -> tuple[str, ...]:
        """The families of the d features, by name; see :attr:`placecue.Cue.families`."""
        return tuple(family.name for family in self.feature_families() for _ in family.names)

    def feature_families(self) -> tuple[Family, ...]:
        """Return the features in families of one meaning and unit.

        Raises
        ------
        UsageError
            If a parameter cannot be.
        """
        if self.preset not in PRESETS:
            raise UsageError(f"unknown preset '{self.preset}'; {choices(self.preset, PRESETS)}")
        if self.preset == "group":
            return group.families()
        self._check()
        return FullFeatures(
            self.clips,
            self.gaps,
            self.relative_gaps,
            self.fourier,
            self.line_tolerance,
            self.line_beams,
            self.minima_depth,
            self.hu_floor,
            self.field_of_view,
        ).families()

    def extract(self, observation: Observation) -> NDArray[np.float64]:
        """Return the features of the observation's scan, shape (d,).

        Raises
        ------
        UnusableObservation
            If the scan is empty, has no valid beam, or contradicts itself.
        UsageError
            If a parameter cannot be.
        """
        scan = _scan(observation)
        return np.asarray(self._features(_ranges(scan)[None], scan.angles)[0])

    def augmentations(self) -> Sequence[Augmentation]:
        """Return what scales a scan, for each of ``scales`` but 1.

        Raises
        ------
        UsageError
            If a scale is not above 0.
        """
        if not all(scale > 0 for scale in self.scales):
            raise UsageError(f"laser scales must be above 0, got {list(self.scales)}")
        return [partial(_scaled, scale=scale) for scale in self.scales if scale != 1]

    def transform(self, observations: Iterable[Observation]) -> FeatureBatch:
        """Return the features of several observations, shape (n, d); see :class:`Cue`.

        Scans with equal beams are computed together.
        """
        batches = [
            self._features(np.stack([_ranges(scan) for scan in scans]), scans[0].angles)
            for scans in _alike(map(_scan, observations))
        ]
        return np.concatenate(batches) if batches else stack([])

    def _features(
        self, ranges: NDArray[np.float64], angles: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        families = self.feature_families()
        if self.preset == "group":
            # The group's code kept ranges in single precision, which decides gaps at the edge.
            single = ranges.astype(np.float32).astype(np.float64)
            return evaluate(families, Beams(single, angles, cyclic=True))
        step, grazing = np.radians(self.angular_step), np.radians(self.grazing_angle)
        return evaluate(families, resample(ranges, angles, step, grazing))

    def _check(self) -> None:
        check_flag("field_of_view", self.field_of_view)
        positive = ("angular_step", "fourier", "line_tolerance", "line_beams", "hu_floor")
        wrong = [
            f"{name}={getattr(self, name)}" for name in positive if not getattr(self, name) > 0
        ]
        if wrong:
            raise UsageError(f"laser parameters must be above 0, got {', '.join(wrong)}")


def _scaled(observation: Observation, scale: float) -> Observation:
    return observation.altered(f"scaled by {scale!r}", scan=_scan(observation).scaled(scale))


def _scan(observation: Observation) -> LaserScan:
    if observation.scan is None:
        raise UnusableObservation(f"no scan at stamp {observation.stamp}")
    return observation.scan


def _ranges(scan: LaserScan) -> NDArray[np.float64]:
    """Return the ranges with invalid beams at the maximum, m, once they are known to be sound."""
    ranges = scan.filled()
    if scan.angles.shape != ranges.shape:
        raise UnusableObservation(
            f"the laser scan has {ranges.size} ranges and {scan.angles.size} angles"
        )
    if not np.isfinite(ranges).all():
        raise UnusableObservation(
            "the laser scan has beams without an echo and no finite range_max to put in their "
            "place: give the scanner's maximum range"
        )
    if not (np.diff(scan.angles) >= 0).all():
        raise UnusableObservation("the angles of the laser scan do not increase, or hold NaN")
    return ranges


def _alike(scans: Iterable[LaserScan]) -> Iterator[list[LaserScan]]:
    """Yield runs of scans that have the same angles, of limited length."""
    for _, run in groupby(scans, key=lambda scan: scan.angles.tobytes()):
        batch: list[LaserScan] = []
        for scan in run:
            batch.append(scan)
            if len(batch) == _BATCH:
                yield batch
                batch = []
        if batch:
            yield batch
