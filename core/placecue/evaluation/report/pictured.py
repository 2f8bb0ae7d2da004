"""What was seen at a moment, as a page shows it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.report.figure import data_uri
from placecue.evaluation.report.scan_drawing import Drawing, draw_scan


class Pictured:
    """A moment with a picture and a scan, as far as there are any.

    Attributes
    ----------
    image : bytes
        A small JPEG; empty where there is none.
    scan : ndarray of float64, shape (k, 2), or None
        Where the laser hit, in the robot's frame, m.
    """

    image: bytes
    scan: NDArray[np.float64] | None

    @property
    def source(self) -> str:
        """The picture as a data URI."""
        return data_uri(self.image, "jpeg")

    @property
    def drawing(self) -> Drawing | None:
        """The scan from above; None where there is none."""
        return None if self.scan is None or not len(self.scan) else draw_scan(self.scan)
