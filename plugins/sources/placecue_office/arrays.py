"""The flat arrays that the compiled kernels read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: Surface numbers of floor and ceiling, before it is known whose.
FLOOR, CEILING = -1, -2


class Geometry(NamedTuple):
    """Where surfaces are.

    Attributes
    ----------
    faces : ndarray of float64, shape (n, 4)
        Ends of each upright face in the plan: x0, y0, x1, y1 in m.
    spans : ndarray of float64, shape (n, 2)
        Height range of each face, m.
    starts : ndarray of int64, shape (m + 1,)
        First face of each block.
    caps : ndarray of float64, shape (m, 2)
        Heights of bottom and top of each block, m; NaN where they are never seen.
    ceiling : float
        Height of the ceiling, m.
    """

    faces: NDArray[np.float64]
    spans: NDArray[np.float64]
    starts: NDArray[np.int64]
    caps: NDArray[np.float64]
    ceiling: float

    def cut(self, height: float) -> NDArray[np.float64]:
        """Return the faces that a horizontal plane meets, x0, y0, x1, y1 in m, shape (k, 4)."""
        low, high = self.spans.T
        return np.ascontiguousarray(self.faces[(low <= height) & (height < high)])


class Skin(NamedTuple):
    """What surfaces look like.

    Surfaces are numbered: first one for each face, then one for each block's top and bottom,
    then the floor of each room, then the ceiling of each room.

    Attributes
    ----------
    textures : ndarray of int64, shape (s,)
        Texture of each surface.
    scales : ndarray of float64, shape (s, 2)
        Repeats of it a metre, across and up.
    glows : ndarray of float64, shape (s,)
        Light of its own: positive shines as the sky does, negative as the lamps do.
    texels : ndarray of uint8, shape (p, 3)
        All pixels of all textures at all sizes, row by row.
    offsets, widths, heights : ndarray of int64, shape (textures, levels)
        Where each texture begins at each size, and its size in pixels, powers of two.
    """

    textures: NDArray[np.int64]
    scales: NDArray[np.float64]
    glows: NDArray[np.float64]
    texels: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    widths: NDArray[np.int64]
    heights: NDArray[np.int64]


class Sun(NamedTuple):
    """Sunlight through windows.

    Attributes
    ----------
    windows : ndarray of float64, shape (k, 7)
        Those that the sun shines through: ends in the plan, lower and upper edge, m, and room.
    toward : ndarray of float64, shape (5,)
        Where the sun is: direction in the plan, rise a metre, cosine and sine of its elevation.
    colour : ndarray of float64, shape (3,)
        Light on a surface that faces it.
    """

    windows: NDArray[np.float64]
    toward: NDArray[np.float64]
    colour: NDArray[np.float64]


class Ground(NamedTuple):
    """What depends on the place in the plan.

    Attributes
    ----------
    rooms : ndarray of int64, shape (rows, columns)
        The nearest room of each cell.
    light : ndarray of float32, shape (rows, columns, 3)
        Light in each cell.
    contact : ndarray of float32, shape (rows, columns)
        What part of it reaches the floor there, beside and under furniture.
    shine : ndarray of float64, shape (2, 3)
        Brightness of windows and of lamps.
    x, y : float
        Lower left corner of the cells, m.
    cell : float
        Width of a cell, m.
    sun : Sun
        What falls through the windows besides.
    """

    rooms: NDArray[np.int64]
    light: NDArray[np.float32]
    contact: NDArray[np.float32]
    shine: NDArray[np.float64]
    x: float
    y: float
    cell: float
    sun: Sun


class Eye(NamedTuple):
    """An upright pinhole camera.

    Attributes
    ----------
    x, y, z : float
        Position, m.
    cos, sin : float
        Of its heading.
    focal : float
        Focal length, pixels.
    """

    x: float
    y: float
    z: float
    cos: float
    sin: float
    focal: float
