"""Which images cues take, and their grey levels."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.errors import UnusableObservation
from placecue.observation import Observation

#: What a grey level is divided by to lie in [0, 255].
GREY_SCALES: dict[np.dtype[Any], int] = {np.dtype(np.uint8): 1, np.dtype(np.uint16): 257}


def checked(observation: Observation, cue: str) -> NDArray[Any]:
    """Return the observation's image once it is known to be of a kind that cues take.

    Parameters
    ----------
    observation : Observation
        Has an image.
    cue : str
        Who asks, for the message.

    Returns
    -------
    ndarray
        8-bit RGB, shape (H, W, 3), or 8 or 16-bit grey, shape (H, W).

    Raises
    ------
    UnusableObservation
        If the image is of another kind or has no pixels.
    """
    image = np.asarray(observation.image)
    colour = image.ndim == 3 and image.shape[2] == 3 and image.dtype == np.uint8
    grey = image.ndim == 2 and image.dtype in GREY_SCALES
    if not (colour or grey):
        raise UnusableObservation(
            f"{cue} takes 8-bit RGB (H, W, 3) or 8 or 16-bit grey (H, W) images, got "
            f"{image.dtype} of shape {image.shape}"
        )
    return image


def eight_bit(image: NDArray[Any]) -> NDArray[np.uint8]:
    """Return a checked image with 16-bit grey levels rounded to 8 bits."""
    if image.dtype == np.uint8:
        return image
    return np.asarray(np.rint(image / GREY_SCALES[image.dtype]), dtype=np.uint8)


def grey(observation: Observation, cue: str) -> NDArray[np.uint8]:
    """Return the grey levels of the observation's image, shape (H, W).

    Those of a colour are its luma, 0.299 R + 0.587 G + 0.114 B.

    Raises
    ------
    UnusableObservation
        As :func:`checked`, or if there is no pixel.
    """
    image = eight_bit(checked(observation, cue))
    if image.size == 0:
        raise UnusableObservation(f"{cue} got an image without pixels, {image.shape}")
    return image if image.ndim == 2 else _eight(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY))


def _eight(image: Any) -> NDArray[np.uint8]:
    return np.asarray(image, dtype=np.uint8)
