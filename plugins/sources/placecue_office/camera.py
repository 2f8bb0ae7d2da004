"""The robot's camera."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.observation import Image, Pose2D
from placecue_office.arrays import Eye, Geometry, Ground, Skin
from placecue_office.shade import develop, shade
from placecue_office.trace import trace

#: What is brighter counts as this for the exposure: windows and lamps leave a room darker.
BRIGHTEST = 3.0


@dataclass(frozen=True, slots=True)
class Camera:
    """An upright pinhole camera that looks ahead, with automatic exposure and sensor noise.

    Parameters
    ----------
    width, height : int
        Size of the image, pixels.
    field_of_view : float
        Horizontal, degrees.
    above_floor : float
        Height of the optical axis, m.
    noise : float
        Standard deviation of the sensor's noise at an exposure of 1, grey levels.
    exposure : float
        Mean of the linear image that the automatic exposure aims at.
    shutter : float
        Time that the shutter is open at an exposure of 1, s; 0 blurs nothing.
    longest : float
        Longest time that it is open, s.
    flare : float
        Part of the light that the lens scatters all over the image.
    strongest : float
        Largest exposure: in less light the image gets darker.
    """

    width: int
    height: int
    field_of_view: float
    above_floor: float
    noise: float
    exposure: float = 0.2
    shutter: float = 0.0
    longest: float = 0.04
    flare: float = 0.08
    strongest: float = 1.75

    def eye(self, pose: Pose2D) -> Eye:
        """Return the camera as the kernels see it."""
        focal = 0.5 * self.width / np.tan(np.radians(0.5 * self.field_of_view))
        cos, sin = float(np.cos(pose.theta)), float(np.sin(pose.theta))
        return Eye(pose.x, pose.y, self.above_floor, cos, sin, float(focal))

    def meter(self, geometry: Geometry, skin: Skin, ground: Ground, pose: Pose2D) -> float:
        """Return the exposure that suits a view, from a small image of it."""
        small = replace(self, width=max(self.width // 10, 8), height=max(self.height // 10, 6))
        light = small._light(geometry, skin, ground, pose)
        mean = float(np.minimum(light, BRIGHTEST).mean())
        return min(self.exposure / max(mean, 0.01), self.strongest)

    def shoot(
        self,
        geometry: Geometry,
        skin: Skin,
        ground: Ground,
        pose: Pose2D,
        key: int,
        gain: float | None = None,
        turning: float = 0.0,
    ) -> Image:
        """Take an image.

        Parameters
        ----------
        geometry, skin, ground
            The world.
        pose : Pose2D
            Where the robot truly is.
        key : int
            Decides the noise of this image.
        gain : float, optional
            Exposure; what suits this view if None.
        turning : float
            How fast the robot turns, rad/s.

        Returns
        -------
        ndarray of uint8, shape (height, width, 3)
            RGB.
        """
        if gain is None:
            gain = self.meter(geometry, skin, ground, pose)
        light = self._light(geometry, skin, ground, pose)
        light += np.float32(self.flare * light.mean())
        streak = abs(turning) * min(self.shutter * gain, self.longest) * self.eye(pose).focal
        return np.asarray(develop(blurred(light, streak), gain, self.noise, np.uint64(key)))

    def _light(
        self, geometry: Geometry, skin: Skin, ground: Ground, pose: Pose2D
    ) -> NDArray[np.float32]:
        eye = self.eye(pose)
        depth, surface = trace(geometry, eye, self.width, self.height)
        return np.asarray(shade(depth, surface, geometry, skin, ground, eye))


def blurred(light: NDArray[np.float32], streak: float) -> NDArray[np.float32]:
    """Return linear light smeared along the rows, as turning does while the shutter is open.

    Parameters
    ----------
    light : ndarray, shape (height, width, 3)
    streak : float
        Length of the smear, pixels; under one, nothing is done. What driving adds is shorter than
        a pixel on all but the nearest things.
    """
    if streak <= 1.0:
        return light
    side = int(np.ceil(0.5 * (streak - 1.0)))
    kernel = np.ones(2 * side + 1, dtype=np.float32)
    kernel[[0, -1]] = 0.5 * (streak - (2 * side - 1))
    smeared = cv2.sepFilter2D(
        light, -1, kernel / kernel.sum(), np.ones(1, np.float32), borderType=cv2.BORDER_REPLICATE
    )
    return np.asarray(smeared, dtype=np.float32)
