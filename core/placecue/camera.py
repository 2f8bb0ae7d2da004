"""The camera that took the images."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PinholeCamera:
    """A camera without distortion.

    Parameters
    ----------
    width, height : int
        Size of the image, pixels.
    fx, fy : float
        Focal lengths, pixels.
    cx, cy : float
        Where the optical axis meets the image: column and row, pixels.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def k(self) -> tuple[float, ...]:
        """The 3 x 3 matrix from points in the camera's frame to pixels, row by row."""
        return (self.fx, 0.0, self.cx, 0.0, self.fy, self.cy, 0.0, 0.0, 1.0)

    @property
    def p(self) -> tuple[float, ...]:
        """The 3 x 4 projection matrix, row by row."""
        return (self.fx, 0.0, self.cx, 0.0, 0.0, self.fy, self.cy, 0.0, 0.0, 0.0, 1.0, 0.0)
