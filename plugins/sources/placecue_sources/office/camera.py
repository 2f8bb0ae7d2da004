"""The robot's camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from placecue.observation import Image, Pose2D
from placecue_sources.office.arrays import Eye, Geometry, Ground, Skin
from placecue_sources.office.shade import develop, shade
from placecue_sources.office.trace import trace


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
    """

    width: int
    height: int
    field_of_view: float
    above_floor: float
    noise: float
    exposure: float = 0.2

    def eye(self, pose: Pose2D) -> Eye:
        """Return the camera as the kernels see it."""
        focal = 0.5 * self.width / np.tan(np.radians(0.5 * self.field_of_view))
        cos, sin = float(np.cos(pose.theta)), float(np.sin(pose.theta))
        return Eye(pose.x, pose.y, self.above_floor, cos, sin, float(focal))

    def shoot(
        self, geometry: Geometry, skin: Skin, ground: Ground, pose: Pose2D, key: int
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

        Returns
        -------
        ndarray of uint8, shape (height, width, 3)
            RGB.
        """
        eye = self.eye(pose)
        depth, surface = trace(geometry, eye, self.width, self.height)
        light = shade(depth, surface, geometry, skin, ground, eye)
        gain = self.exposure / max(float(np.minimum(light, 1.0).mean()), 0.01)
        return np.asarray(develop(light, gain, self.noise, np.uint64(key)))
