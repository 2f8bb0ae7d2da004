"""What a log says of a camera, carried to the size of the images that it sends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from placecue.depth import Intrinsics
from placecue.errors import UnusableObservation

#: How far the sides of an image may be scaled unlike, from rounding to whole pixels.
UNLIKE = 0.02


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """A camera as sensor_msgs/CameraInfo or foxglove.CameraCalibration describe it.

    Parameters
    ----------
    width, height : int
        Size that the matrix belongs to, pixels; 0 where it is not said.
    fx, cx, cy : float
        Focal length and optical axis at that size, pixels.
    binning : tuple of 2 int
        How many pixels are joined to one, across and down.
    left, top : int
        Where the region that is sent begins, pixels of the whole.
    region : tuple of 2 int
        Its size, pixels of the whole; 0 for all.
    """

    width: int
    height: int
    fx: float
    cx: float
    cy: float
    binning: tuple[int, int] = (1, 1)
    left: int = 0
    top: int = 0
    region: tuple[int, int] = (0, 0)

    def of_image(self, width: int, height: int) -> Intrinsics:
        """Return the intrinsics of an image, pixels.

        The matrix is that of the whole sensor; what is sent is its region, binned. An image that
        is a scaled copy of that has its intrinsics scaled.

        Raises
        ------
        UnusableObservation
            If the image has another shape than the camera.
        """
        if (width, height) == (self.width, self.height) or 0 in (self.width, self.height):
            return Intrinsics(self.fx, self.cx, self.cy)
        across, down = self.binning
        sent = (self.region[0] or self.width) / across, (self.region[1] or self.height) / down
        scale = width / sent[0], height / sent[1]
        if abs(scale[0] / scale[1] - 1.0) > UNLIKE:
            raise UnusableObservation(
                f"the depth image has {width} x {height} pixels, and its camera is described for "
                f"{sent[0]:g} x {sent[1]:g}: they do not have one shape"
            )
        x, y = scale[0] / across, scale[1] / down
        # The middle of the first pixel is at 0, so sizes scale about -0.5.
        cx, cy = (self.cx - self.left + 0.5) * x - 0.5, (self.cy - self.top + 0.5) * y - 0.5
        return Intrinsics(self.fx * x, cx, cy)


def camera_info(message: Any) -> CameraInfo | None:
    """Return what a message says of a camera; None where it says nothing usable.

    Parameters
    ----------
    message : object
        A decoded sensor_msgs/CameraInfo or foxglove.CameraCalibration.
    """
    k = [float(each) for each in _first(message, "k", "K", default=())]
    if len(k) != 9 or not np.isfinite(k).all() or k[0] <= 0:
        return None
    region = _first(message, "roi", default=None)
    of_region = {
        name: 0 if region is None else int(_first(region, name, default=0))
        for name in ("x_offset", "y_offset", "width", "height")
    }
    return CameraInfo(
        int(_first(message, "width", default=0)),
        int(_first(message, "height", default=0)),
        k[0],
        k[2],
        k[5],
        (
            max(int(_first(message, "binning_x", default=1)), 1),
            max(int(_first(message, "binning_y", default=1)), 1),
        ),
        of_region["x_offset"],
        of_region["y_offset"],
        (of_region["width"], of_region["height"]),
    )


def _first(message: Any, *names: str, default: Any) -> Any:
    """Return the first field that a message has, be it read like a mapping or by attributes."""
    for name in names:
        mapping = hasattr(message, "get")
        found = message.get(name) if mapping else getattr(message, name, None)
        if found is not None and (not hasattr(found, "__len__") or len(found)):
            return found
    return default
