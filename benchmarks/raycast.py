"""Laser scans in an occupancy grid: ``python benchmarks/raycast.py [PICTURE_OF_A_MAP]``.

One scan in the middle of an empty square of 40 m; with a picture, 1,000 scans of its floor plan.
"""

import sys
from time import perf_counter

import numpy as np

from placecue_sources.floorplan import FloorPlan
from placecue_sources.raycast import OccupancyGrid, cast_rays

BEAMS, SIDE, REPEATS = 361, 800, 200


def scan(max_range: float) -> float:
    """Return the median time of one scan, ms."""
    occupied = np.zeros((SIDE, SIDE), dtype=np.uint8)
    occupied[[0, -1]] = occupied[:, [0, -1]] = 1
    grid = OccupancyGrid(occupied, 0.05)
    bearings = np.linspace(-np.pi / 2, np.pi / 2, BEAMS)
    middle = SIDE * 0.05 / 2
    times = []
    for _ in range(REPEATS):
        start = perf_counter()
        cast_rays(grid, middle, middle, bearings, max_range)
        times.append(perf_counter() - start)
    return 1e3 * float(np.median(times))


def plan(path: str, samples: int = 1000) -> float:
    """Return the time of many scans of a floor plan, s; the best of three."""
    source = FloorPlan(path, samples=samples)
    next(iter(source))
    times = []
    for _ in range(3):
        start = perf_counter()
        assert sum(1 for _ in source) == samples
        times.append(perf_counter() - start)
    return min(times)


def main() -> None:
    for max_range in (20.0, np.inf):
        print(f"one scan of {BEAMS} beams, up to {max_range} m: {scan(max_range):.3f} ms")
    for path in sys.argv[1:]:
        print(f"1,000 scans of {path}: {plan(path):.2f} s")


if __name__ == "__main__":
    main()
