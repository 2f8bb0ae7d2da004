"""The files of a frame of an RGB-D data set."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.decoding import decoded
from placecue.errors import DataError, UnusableObservation
from placecue.faults import Faults
from placecue.observation import EncodedImage
from placecue_sources.contents import read_bytes
from placecue_sources.rgbd_frames import Frame

T = TypeVar("T")


class Parts:
    """Reads parts of frames, counts those that cannot be read, and says it once.

    Parameters
    ----------
    where : str
        Name of the data set, for messages.
    frames : int
        How many there are.
    """

    def __init__(self, where: str, frames: int) -> None:
        self.faults = Faults(where)
        self.kind = f"parts of {frames} frames cannot be read"
        self.read = 0

    def tried(self, read: Callable[[Frame], T], frame: Frame) -> T | None:
        """Return what ``read`` gives of a frame; None where it cannot."""
        try:
            part = read(frame)
        except UnusableObservation as error:
            self.faults.add(self.kind, error)
            return None
        self.read += 1
        return part

    def report(self) -> None:
        """Warn once of what could not be read, if anything.

        Raises
        ------
        DataError
            If nothing at all could be read.
        """
        if self.faults.counts and self.read == 0:
            cause = self.faults.cause
            raise DataError(f"{self.faults.where}: {self.faults.told()}") from cause
        self.faults.report()


def picture(frame: Frame) -> EncodedImage:
    """Return the picture of a frame, undecoded.

    Raises
    ------
    UnusableObservation
        If there is none.
    """
    path, data = _bytes_of(frame.image, "colour image", frame)
    return EncodedImage(data, "png" if path.suffix.lower() == ".png" else "jpeg", str(path))


def depth_image(frame: Frame) -> NDArray[np.float64]:
    """Return the depth image of a frame in its own units, shape (H, W).

    Raises
    ------
    UnusableObservation
        If there is none, or it is no picture of one channel.
    """
    path, data = _bytes_of(frame.depth, "depth image", frame)
    image = decoded(data, str(path), cv2.IMREAD_UNCHANGED)
    if image.ndim != 2:
        raise UnusableObservation(f"{path} is no depth image: it has {image.shape[2]} channels")
    return np.asarray(image, dtype=np.float64)


def _bytes_of(path: Path | None, what: str, frame: Frame) -> tuple[Path, bytes]:
    if path is None:
        raise UnusableObservation(f"the frame at stamp {frame.stamp} has no {what}")
    try:
        return path, read_bytes(path)
    except DataError as error:
        raise UnusableObservation(str(error)) from error
