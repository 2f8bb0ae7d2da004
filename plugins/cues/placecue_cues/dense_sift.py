"""RootSIFT descriptors of square patches on a grid, at several scales."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.errors import UnusableObservation, UsageError
from placecue.observation import Observation

from .images import grey
from .local_descriptors import LocalDescriptors, Patches, Single
from .root_sift import root_sift

_ORIENTATIONS = 8
_CELLS = 4
#: SIFT: no entry of the unit-length descriptor above this.
_CUT = np.float32(0.2)
#: Blur before the gradient, as a share of the width of a cell.
_BLUR = 1 / 6


class DenseSift(LocalDescriptors):
    """Upright RootSIFT descriptors of all patches of a grid that have contrast, shape (n, 128).

    A descriptor holds for each of 4 x 4 square cells a histogram of 8 gradient directions,
    linearly interpolated in place and direction as in SIFT, the cells weighted by SIFT's Gaussian
    at their centres. They are float32 of unit length; an image without any contrast has none.

    Parameters
    ----------
    longest_side : int
        The image is reduced to this first, pixels; a smaller one stays as it is.
    step : int
        Distance between patches, pixels.
    cells : sequence of int
        Widths of a cell, pixels; one scale each. A patch is four cells wide.
    contrast : float
        Patches whose descriptor, before it is made to unit length, is shorter are left out. Its
        entries then are mean gradients over the cells, grey levels a pixel.

    References
    ----------
    Lowe, IJCV 60(2), 2004. Arandjelovic and Zisserman, CVPR 2012 (RootSIFT).
    """

    def __init__(
        self,
        longest_side: int = 320,
        step: int = 6,
        cells: Sequence[int] = (4, 6, 8, 10),
        contrast: float = 1.0,
    ) -> None:
        self.longest_side = longest_side
        self.step = step
        self.cells = cells
        self.contrast = contrast

    def check_parameters(self) -> None:
        """Raise UsageError if a parameter cannot be."""
        if not self.cells or min(self.longest_side, self.step, *self.cells) < 1:
            raise UsageError(
                "dense_sift needs longest_side, step and cells of at least 1 pixel, got "
                f"{self.longest_side}, {self.step} and {list(self.cells)}"
            )
        if not self.contrast >= 0:
            raise UsageError(f"dense_sift needs contrast >= 0, got {self.contrast}")

    def patches(self, observation: Observation) -> Patches:
        """Return the descriptors of the observation's image and their places.

        Raises
        ------
        UnusableObservation
            If the image is not an 8-bit RGB or 8 or 16-bit grey one, or too small for one patch.
        UsageError
            If a parameter cannot be.
        """
        self.check_parameters()
        plane = self._reduced(grey(observation, "dense_sift"))
        scales = [self._scale(plane, cell) for cell in self.cells if _fits(plane, cell)]
        if not scales:
            height, width = plane.shape
            raise UnusableObservation(
                f"the image is {width}x{height} pixels, dense_sift needs "
                f"{_CELLS * min(self.cells)} each way for its smallest patch"
            )
        return Patches(*(np.concatenate(parts) for parts in zip(*scales, strict=True)))

    def _reduced(self, plane: NDArray[np.uint8]) -> Single:
        scale = self.longest_side / max(plane.shape)
        if scale < 1:
            height, width = (max(round(side * scale), 1) for side in plane.shape)
            reduced = cv2.resize(plane, (width, height), interpolation=cv2.INTER_AREA)
            return np.asarray(reduced, dtype=np.float32)
        return plane.astype(np.float32)

    def _scale(self, plane: Single, cell: int) -> tuple[Single, Single]:
        """Return descriptors and places of the patches of one scale."""
        height, width = plane.shape
        rows = np.arange(cell // 2, height - (_CELLS * cell - cell // 2) + 1, self.step)
        columns = np.arange(cell // 2, width - (_CELLS * cell - cell // 2) + 1, self.step)
        raw = np.empty((len(rows), len(columns), _CELLS, _CELLS, _ORIENTATIONS), np.float32)
        offsets = np.arange(_CELLS) - (_CELLS - 1) / 2
        weights = np.exp(-(offsets**2) / (2 * (_CELLS / 2) ** 2)).astype(np.float32)
        for orientation, energy in enumerate(_energies(plane, cell)):
            for i in range(_CELLS):
                down = energy[rows[0] + i * cell :: self.step][: len(rows)]
                for j in range(_CELLS):
                    part = down[:, columns[0] + j * cell :: self.step][:, : len(columns)]
                    np.multiply(part, weights[i] * weights[j], out=raw[:, :, i, j, orientation])
        middle = (_CELLS - 1) / 2 * cell
        places = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1) + middle
        shares = (places / (height, width)).astype(np.float32).reshape(-1, 2)
        descriptors = raw.reshape(len(shares), -1)
        lengths = np.sqrt(np.einsum("ij,ij->i", descriptors, descriptors))
        kept = (lengths > self.contrast) & (lengths > 0)
        descriptors, lengths = descriptors[kept], lengths[kept, None]
        descriptors /= lengths
        return root_sift(np.minimum(descriptors, _CUT, out=descriptors), out=True), shares[kept]


def _fits(plane: Single, cell: int) -> bool:
    return bool(min(plane.shape) >= _CELLS * cell)


def _energies(plane: Single, cell: int) -> Iterator[Single]:
    """Yield the gradient energy around each pixel for each direction; averages over a cell."""
    smooth = cv2.GaussianBlur(plane, (0, 0), max(cell * _BLUR, 0.1))
    dx = cv2.Sobel(smooth, cv2.CV_32F, 1, 0, ksize=1, scale=0.5, borderType=cv2.BORDER_REPLICATE)
    dy = cv2.Sobel(smooth, cv2.CV_32F, 0, 1, ksize=1, scale=0.5, borderType=cv2.BORDER_REPLICATE)
    lengths, angles = cv2.cartToPolar(dx, dy)
    turns = angles * np.float32(_ORIENTATIONS / (2 * np.pi))
    tent = (cell - np.abs(np.arange(1 - cell, cell))) / cell**2
    for orientation in range(_ORIENTATIONS):
        off = np.abs(turns - np.float32(orientation))
        near = np.minimum(off, _ORIENTATIONS - off)
        share = np.maximum(1 - near, 0)
        energy = cv2.sepFilter2D(lengths * share, -1, tent, tent, borderType=cv2.BORDER_CONSTANT)
        yield np.asarray(energy, dtype=np.float32)
