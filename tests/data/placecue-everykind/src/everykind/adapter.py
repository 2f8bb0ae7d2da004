"""A message adapter."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from placecue import Adapter, LaserScan, Role, UnusableObservation


class AcmeBeams(Adapter):
    """acme.Beams, in JSON: ``{"ms": 12, "cm": [100, ...]}`` over half a turn."""

    encodings: ClassVar[tuple[str, ...]] = ("json",)
    schemas: ClassVar[tuple[str, ...]] = ("acme.Beams",)
    role: ClassVar[Role] = "scan"

    def stamp(self, message: Any) -> int:
        """Return the time of the scan, ns."""
        return int(message["ms"]) * 1_000_000

    def value(self, message: Any, origin: str) -> LaserScan:
        """Return the scan."""
        beams = np.asarray(message["cm"], dtype=np.float64) / 100
        if beams.size < 2:
            raise UnusableObservation(f"{origin}: {beams.size} beams")
        angles = np.radians(np.linspace(-90, 90, beams.size))
        return LaserScan(angles, beams, 0.0, 30.0)
