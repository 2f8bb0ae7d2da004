"""Images as they lie in a log, decoded on first use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from placecue.errors import UnusableObservation
from placecue.observation import Image

#: Bytes a pixel, and which of them are red, green and blue; None is grey.
PIXELS: dict[str, tuple[int, tuple[int, int, int] | None]] = {
    "mono8": (1, None),
    "8uc1": (1, None),
    "rgb8": (3, (0, 1, 2)),
    "bgr8": (3, (2, 1, 0)),
    "8uc3": (3, (2, 1, 0)),
    "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)),
    "8uc4": (4, (2, 1, 0)),
}


@dataclass(frozen=True, slots=True)
class RawImage:
    """Uncompressed pixels as they lie in a log, converted when called.

    Parameters
    ----------
    data : bytes
        The rows, each ``step`` bytes long.
    height, width : int
        Size, pixels.
    step : int
        Length of a row, bytes; 0 where rows are not padded.
    encoding : str
        Name of the pixel format, such as ``bgr8`` (see sensor_msgs/image_encodings).
    origin : str
        Where it comes from, for messages.
    """

    data: bytes
    height: int
    width: int
    step: int
    encoding: str
    origin: str = "image"

    def __call__(self) -> Image:
        """Convert to RGB (H, W, 3), or to grey (H, W) where the pixels are grey.

        Raises
        ------
        UnusableObservation
            If the pixel format is not known, or there are too few bytes.
        """
        if self.encoding.lower() not in PIXELS:
            raise UnusableObservation(
                f"{self.origin}: pixel format '{self.encoding}' is not known; "
                f"known: {', '.join(sorted(PIXELS))}"
            )
        depth, order = PIXELS[self.encoding.lower()]
        step = self.step or self.width * depth
        if step < self.width * depth or len(self.data) < self.height * step or not self.data:
            raise UnusableObservation(
                f"{self.origin}: {len(self.data)} bytes are not {self.width} x {self.height} "
                f"pixels of {self.encoding} in rows of {step}"
            )
        rows = np.frombuffer(self.data, np.uint8, self.height * step).reshape(self.height, step)
        pixels = rows[:, : self.width * depth].reshape(self.height, self.width, depth)
        return np.ascontiguousarray(pixels[:, :, 0] if order is None else pixels[:, :, order])
