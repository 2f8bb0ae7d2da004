"""Local descriptors at interest points of the image."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from placecue.errors import UsageError
from placecue.observation import Observation

from .images import grey
from .local_descriptors import LocalDescriptors, Patches
from .root_sift import root_sift

_LENGTH = 128


class SIFT(LocalDescriptors):
    """SIFT descriptors at the extrema of differences of Gaussians, float32 of shape (n, 128).

    They come in order of falling response. An image without interest points, such as a bare wall,
    gives an empty set, shape (0, 128).

    Parameters
    ----------
    keypoints : int
        At most so many, those of the strongest response.
    root : bool
        RootSIFT: descriptors of unit length whose Euclidean distance is that of Hellinger between
        the SIFT histograms. Otherwise as OpenCV gives them, of length about 512.
    contrast_threshold : float
        Extrema of less contrast are dropped.
    edge_threshold : float
        Extrema whose ratio of curvatures is above, which lie on edges, are dropped.
    octave_layers : int
        Scales to an octave.
    sigma : float
        Blur of the first octave, pixels.

    References
    ----------
    Lowe, Distinctive image features from scale-invariant keypoints, IJCV 60(2), 2004.
    Arandjelovic and Zisserman, CVPR 2012 (RootSIFT).
    """

    def __init__(
        self,
        keypoints: int = 150,
        root: bool = True,
        contrast_threshold: float = 0.04,
        edge_threshold: float = 10.0,
        octave_layers: int = 3,
        sigma: float = 1.6,
    ) -> None:
        self.keypoints = keypoints
        self.root = root
        self.contrast_threshold = contrast_threshold
        self.edge_threshold = edge_threshold
        self.octave_layers = octave_layers
        self.sigma = sigma

    def patches(self, observation: Observation) -> Patches:
        """Return the descriptors of the observation's image, shape (n, 128), and their places.

        Raises
        ------
        UnusableObservation
            If the image is not an 8-bit RGB or 8 or 16-bit grey one, or has no pixels.
        UsageError
            If a parameter cannot be.
        """
        plane = grey(observation, "sift")
        found, descriptors = self._detector().detectAndCompute(plane, None)
        if descriptors is None:
            return Patches(np.empty((0, _LENGTH), np.float32), np.empty((0, 2), np.float32))
        # OpenCV's own cap keeps ties and its order is that of the pyramid.
        order = sorted(range(len(found)), key=lambda i: _rank(found[i]))[: self.keypoints]
        strongest = np.ascontiguousarray(descriptors[order], dtype=np.float32)
        places = np.array([found[i].pt[::-1] for i in order], np.float32) / plane.shape
        shares = np.clip(places, 0, 1).astype(np.float32)
        return Patches(root_sift(strongest, out=True) if self.root else strongest, shares)

    def _detector(self) -> Any:
        positive = ("keypoints", "contrast_threshold", "edge_threshold", "octave_layers", "sigma")
        wrong = [
            f"{name}={getattr(self, name)}" for name in positive if not getattr(self, name) > 0
        ]
        if wrong:
            raise UsageError(f"sift parameters must be above 0, got {', '.join(wrong)}")
        return cv2.SIFT_create(  # type: ignore[attr-defined]
            self.keypoints,
            self.octave_layers,
            self.contrast_threshold,
            self.edge_threshold,
            self.sigma,
        )


def _rank(point: cv2.KeyPoint) -> tuple[float, ...]:
    """Sort by falling response; ties by place, size and direction, so that order is one."""
    return -point.response, point.pt[1], point.pt[0], point.size, point.angle
