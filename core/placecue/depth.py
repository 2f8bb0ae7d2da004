"""A laser scan cut from a depth image, for robots with a depth camera and no laser."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import UnusableObservation
from placecue.observation import LaserScan, Pose2D

Floats = NDArray[np.float64]

CENTRE = Pose2D(0.0, 0.0, 0.0, "base_link")


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """A pinhole camera without distortion, as far as a scan along the horizon needs it.

    Parameters
    ----------
    fx : float
        Focal length, in pixels of the depth image's columns.
    cx, cy : float
        Where the optical axis meets the image: column and row, pixels from 0.
    """

    fx: float
    cx: float
    cy: float

    def angles(self, columns: int) -> Floats:
        """Return the direction of each column, rad, from left (positive) to right, (columns,)."""
        return np.asarray(np.arctan2(self.cx - np.arange(columns), self.fx))


def virtual_scan(
    depth: ArrayLike,
    intrinsics: Intrinsics,
    *,
    band: int = 60,
    horizon: float | None = None,
    percentile: float = 5.0,
    min_valid: float = 0.1,
    step: float = 0.5,
    range_min: float = 0.0,
    range_max: float = 10.0,
    mount: Pose2D = CENTRE,
) -> LaserScan:
    """Return what a 2D laser at the camera would have measured.

    Of each column of the image, the rows next to the horizon are taken, and of the depths in
    them a low percentile: a minimum that a few wrong pixels do not spoil. Depth is measured along
    the optical axis, so the range of a column at angle α is depth / cos(α). Columns are not
    evenly spaced in angle; the scan is. A beam takes the smallest range of the columns within
    half a step of it, or that of the nearest column where none is so near.

    The camera is taken to be level: its rows run along the floor.

    Parameters
    ----------
    depth : array_like, shape (H, W)
        Distance along the optical axis, m. Zero, negative, NaN and infinite are invalid: the
        camera measured nothing there.
    intrinsics : Intrinsics
        Of the depth image.
    band : int
        Number of rows around the horizon.
    horizon : float, optional
        Row of the horizon, for a camera that looks up or down a little; the optical axis' by
        default.
    percentile : float
        Of the valid depths of a column, in [0, 100]; the measured one at or below it is taken.
    min_valid : float
        Share of a column's rows that must be valid, in [0, 1]; with fewer, or none, its range is
        NaN.
    step : float
        Angle from one beam to the next, degrees. Beams lie at its multiples, one straight ahead.
    range_min, range_max : float
        The scanner's limits, m; lengths outside are kept, and count as invalid.
    mount : Pose2D
        Where the camera sits on the robot.

    Returns
    -------
    LaserScan
        Angles counter-clockwise: the left of the image has positive angles and comes last.

    Raises
    ------
    UnusableObservation
        If ``depth`` is not an image, the optical axis lies outside of it, so that the intrinsics
        belong to another size, or no row of the band or no beam lies in it.

    Notes
    -----
    ROS's depthimage_to_laserscan does the same with the plain minimum.
    """
    image = np.asarray(depth)
    _check(image, intrinsics)
    rows = _band(image, intrinsics.cy if horizon is None else horizon, band)
    columns = intrinsics.angles(image.shape[1])[::-1]
    ranges = low_percentile(rows, percentile, min_valid)[::-1] / np.cos(columns)
    angles = _multiples(float(columns[0]), float(columns[-1]), float(np.deg2rad(step)))
    beams = _beams(columns, ranges, angles, float(np.deg2rad(step)))
    return LaserScan(angles, beams, range_min, range_max, mount)


def low_percentile(depth: ArrayLike, percentile: float, min_valid: float) -> Floats:
    """Return a low percentile of the valid depths of each column, m, shape (W,).

    Parameters
    ----------
    depth : array_like, shape (rows, W)
        Depths, m; zero, negative, NaN and infinite are invalid.
    percentile : float
        In [0, 100]; the measured depth at or below it is taken, never one between two.
    min_valid : float
        Share of the rows that must be valid; NaN where fewer are, or none.
    """
    values = np.asarray(depth, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        valid = np.isfinite(values) & (values > 0.0)
    counts = valid.sum(axis=0)
    in_order = np.sort(np.where(valid, values, np.inf), axis=0)
    places = (percentile / 100.0 * np.maximum(counts - 1, 0)).astype(np.intp)
    found = in_order[places, np.arange(values.shape[1])]
    enough = counts >= max(1.0, min_valid * values.shape[0])
    return np.where(enough, found, np.nan)


def _check(image: NDArray[np.generic], intrinsics: Intrinsics) -> None:
    if image.ndim != 2 or image.size == 0:
        raise UnusableObservation(f"a depth image has rows and columns; this has {image.shape}")
    height, width = image.shape
    if not (0 <= intrinsics.cx < width and 0 <= intrinsics.cy < height):
        raise UnusableObservation(
            f"the optical axis at column {intrinsics.cx:g}, row {intrinsics.cy:g} is outside the "
            f"depth image of {width} x {height}: the intrinsics belong to another size of image"
        )


def _band(image: NDArray[np.generic], horizon: float, rows: int) -> NDArray[np.generic]:
    """Return the rows around the horizon that lie in the image."""
    first = round(horizon - (rows - 1) / 2)
    band = image[max(first, 0) : max(first + rows, 0)]
    if len(band) == 0:
        raise UnusableObservation(
            f"no row of the band of {rows} around row {horizon:g} lies in the depth image of "
            f"{image.shape[0]} rows"
        )
    return band


def _multiples(low: float, high: float, step: float) -> Floats:
    """Return the multiples of a step from low to high, rad."""
    slack = 1e-9  # a bound that is a multiple itself must not fall to rounding
    first, last = np.ceil(low / step - slack), np.floor(high / step + slack)
    if last < first:
        raise UnusableObservation(
            f"no beam lies in the image: it covers {np.rad2deg(low):.3g} to "
            f"{np.rad2deg(high):.3g} degrees, in steps of {np.rad2deg(step):.3g}"
        )
    return step * np.arange(first, last + 1)


def _beams(columns: Floats, ranges: Floats, angles: Floats, step: float) -> Floats:
    """Return the range of each beam from the angles, rad, and ranges, m, of the columns."""
    beams: Floats = ranges[np.abs(angles[:, None] - columns).argmin(axis=1)]
    numbers = np.rint((columns - angles[0]) / step).astype(np.intp)
    inside = (numbers >= 0) & (numbers < len(angles))
    np.fmin.at(beams, numbers[inside], ranges[inside])
    return beams
