"""Registers the class map of a building to the poses of a log that was driven there.

The end points of all scans are laid over the walls of the map in every rotation, at some scales,
as they are and mirrored (pictures do not say which way y goes, nor how large a pixel is); the shift
comes from their correlation. Then rotation, scale and shift are refined. Nothing of a classifier
enters.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, distance_transform_edt, label
from scipy.optimize import minimize
from scipy.signal import fftconvolve

from placecue import Observation

Points = NDArray[np.float64]

#: Side of a pixel of the maps, m, and of the cells of the rough search.
PIXEL, CELL = 0.05, 0.2
SCALES = (0.8, 0.85, 0.9, 0.95, 1.0, 1.05, 1.1, 1.15, 1.2)
#: Greyer pixels are lines; a place is wider than this, m; a hallway so many times as long as wide.
LIGHT, NARROWEST, LONG = 250, 1.0, 4.0
#: An end point farther than this from a wall tells nothing, m.
FAR = 0.5


@dataclass(frozen=True)
class Registration:
    """From positions of a log, m, to those of a map, m, x to the right and y up.

    Parameters
    ----------
    a, b, c, d : float
        x becomes a x + b y, and y becomes c x + d y: pictures may be drawn by hand.
    x, y : float
        And are shifted by so much, m.
    error : float
        Mean distance of end points from walls, m, none more than 0.5.
    near : float
        Share of end points within 0.2 m of a wall.
    """

    a: float
    b: float
    c: float
    d: float
    x: float
    y: float
    error: float = 0.0
    near: float = 0.0

    def on_map(self, points: Points) -> Points:
        """Return positions on the map, m, shape (n, 2)."""
        return points @ np.array([[self.a, self.c], [self.b, self.d]]) + (self.x, self.y)

    @classmethod
    def turned(cls, angle: float, scale: float, mirrored: bool) -> Registration:
        """Return a rotation (rad) and a scale, of x turned round first where mirrored."""
        c, s, sign = scale * np.cos(angle), scale * np.sin(angle), -1 if mirrored else 1
        return cls(sign * c, -s, sign * s, c, 0.0, 0.0)


class ClassMap:
    """A picture of a building, and what each of its pixels is.

    Parameters
    ----------
    labels : ndarray of str, shape (rows, columns)
        The class of each pixel, empty where there is none; row 0 is the lowest.
    """

    def __init__(self, labels: NDArray[np.str_]) -> None:
        self.labels = labels
        free = labels != ""
        self.walls = free & ~binary_erosion(free)
        self.distance = PIXEL * distance_transform_edt(~self.walls)
        rows, columns = np.nonzero(self.walls)
        wall = _raster(np.column_stack([columns, rows]) * PIXEL + PIXEL / 2)
        self.blurred = cv2.GaussianBlur(wall, (0, 0), 1.0)

    @classmethod
    def of_classes(cls, path: Path, legend: Mapping[int, str]) -> ClassMap:
        """Read a picture whose grey values are classes; others are no place."""
        image = _read(path)
        labels = np.full(image.shape, "", dtype="<U16")
        for value, name in legend.items():
            labels[image == value] = name
        return cls(labels)

    @classmethod
    def of_lines(cls, path: Path) -> ClassMap:
        """Read a picture whose rooms are parted by lines: what is long and narrow is a hallway."""
        image = _read(path)
        numbers, count = label(image > LIGHT)
        labels = np.full(image.shape, "", dtype="<U16")
        for number in range(1, count + 1):
            rows, columns = np.nonzero(numbers == number)
            short, long = sorted((np.ptp(rows) + 1, np.ptp(columns) + 1))
            if short * PIXEL >= NARROWEST:
                labels[rows, columns] = "hallway" if long > LONG * short else "room"
        return cls(labels)

    def label_at(self, x: float, y: float) -> str | None:
        """Return the class at a position on the map, m; None where there is none."""
        column, row = int(x // PIXEL), int(y // PIXEL)
        height, width = self.labels.shape
        if not (0 <= row < height and 0 <= column < width):
            return None
        return str(self.labels[row, column]) or None

    def rooms(self) -> NDArray[np.int64]:
        """Return which room each pixel is in: 0 none, pieces of one class that hang together."""
        numbers = np.zeros(self.labels.shape, dtype=np.int64)
        for name in np.unique(self.labels[self.labels != ""]):
            pieces, _ = label(self.labels == name)
            numbers[pieces > 0] = pieces[pieces > 0] + numbers.max()
        return numbers


def _read(path: Path) -> NDArray[np.uint8]:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE))[::-1]


def end_points(log: Iterable[Observation], longest: float = 15.0, cell: float = 0.1) -> Points:
    """Return where beams of a log ended, one a cell that at least two scans hit, m."""
    seen: dict[tuple[int, int], int] = {}
    for each in log:
        if each.pose is None or each.scan is None:
            continue
        origin = each.pose.compose(each.scan.mount)
        good = each.scan.valid() & (each.scan.ranges < longest)
        angles = each.scan.angles[good] + origin.theta
        ends = np.column_stack([np.cos(angles), np.sin(angles)]) * each.scan.ranges[good, None]
        ends += (origin.x, origin.y)
        cells = np.unique(np.floor(ends / cell).astype(int), axis=0)
        for key in map(tuple, cells.tolist()):
            seen[key] = seen.get(key, 0) + 1
    return (np.array([key for key, n in seen.items() if n >= 2]) + 0.5) * cell


def registered(points: Points, onto: ClassMap) -> Registration:
    """Find where end points lie on a map."""
    rough = [
        _roughly(points, onto, np.deg2rad(degrees), scale, mirrored)
        for mirrored in (False, True)
        for scale in SCALES
        for degrees in range(0, 360, 3)
    ]
    some = points[np.random.default_rng(0).permutation(len(points))[:5000]]
    best = sorted(rough, key=lambda each: -each[0])[:6]
    fine = min((_refined(some, onto, start) for _, start in best), key=lambda each: each.error)
    distances = _distances(fine, points, onto)
    error, near = float(distances.mean()), float((distances < 0.2).mean())
    return replace(fine, error=error, near=near)


def _refined(points: Points, onto: ClassMap, start: Registration) -> Registration:
    """Move a registration to where end points lie nearest to walls, from afar and then closely."""
    at = np.array([start.a, start.b, start.c, start.d, start.x, start.y])
    for far in (4 * FAR, 2 * FAR, FAR):

        def error(tried: NDArray[np.float64], far: float = far) -> float:
            return float(_distances(Registration(*tried), points, onto, far).mean())

        corners = np.array([at, *(at + np.diag([0.03] * 4 + [0.5] * 2))])
        options = {"initial_simplex": corners, "maxiter": 1000, "xatol": 1e-4, "fatol": 1e-6}
        found = minimize(error, at, method="Nelder-Mead", options=options)
        at = found.x
    return Registration(*map(float, at), error=float(found.fun))


def _roughly(
    points: Points, onto: ClassMap, angle: float, scale: float, mirrored: bool
) -> tuple[float, Registration]:
    """Return the share of points near walls, about, and where that is."""
    at = Registration.turned(angle, scale, mirrored)
    turned = at.on_map(points)
    low = turned.min(axis=0)
    image = _raster(turned - low)
    fit = fftconvolve(onto.blurred, image[::-1, ::-1], mode="full")
    row, column = np.unravel_index(int(fit.argmax()), fit.shape)
    shift = np.array([column - image.shape[1] + 1, row - image.shape[0] + 1]) * CELL - low
    found = replace(at, x=float(shift[0]), y=float(shift[1]))
    return float(fit.max() / image.sum()), found


def _raster(points: Points) -> NDArray[np.float64]:
    columns, rows = np.floor(points / CELL).astype(int).T
    image = np.zeros((rows.max() + 1, columns.max() + 1))
    image[rows, columns] = 1
    return image


def _distances(
    at: Registration, points: Points, onto: ClassMap, far: float = FAR
) -> NDArray[np.float64]:
    columns, rows = np.floor(at.on_map(points) / PIXEL).astype(int).T
    height, width = onto.distance.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    found = np.full(len(points), far)
    found[inside] = np.minimum(onto.distance[rows[inside], columns[inside]], far)
    return found
