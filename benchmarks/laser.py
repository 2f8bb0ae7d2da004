"""The 182 laser features against the plain way: ``python benchmarks/laser.py``."""

import os
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from placecue import LaserScan, Observation
from placecue_cues.laser import LaserGeometry

BEAMS = 361
SCANS = 400


def scans() -> list[Observation]:
    """Scans of a cluttered room, 180 degrees."""
    rng = np.random.default_rng(0)
    angles = np.linspace(-np.pi / 2, np.pi / 2, BEAMS)
    walls = np.minimum(
        4 / np.maximum(np.cos(angles), 1e-3), 3 / np.maximum(np.abs(np.sin(angles)), 1e-3)
    )
    steps = np.repeat(rng.uniform(0.3, 1.0, (SCANS, 37)), 10, axis=1)[:, :BEAMS]
    ranges = walls * steps + rng.normal(0, 0.01, (SCANS, BEAMS))
    return [Observation(i, scan=LaserScan(angles, row, 0.0, 30.0)) for i, row in enumerate(ranges)]


def plain(scan: LaserScan) -> NDArray[np.float64]:
    """The costly features, each as its formula says: Fourier coefficients and gaps."""
    points = scan.ranges * np.exp(1j * scan.angles)
    edges = np.roll(points, -1) - points
    lengths = np.abs(edges)
    perimeter = lengths.sum()
    at = np.cumsum(lengths) - lengths
    turns = np.roll(edges / lengths, 1) - edges / lengths
    k = np.r_[-1, 1:101][:, None]
    waves = np.exp(-2j * np.pi * k * at / perimeter)
    harmonics = np.abs(perimeter / (2 * np.pi * k[:, 0]) ** 2 * (waves @ turns))
    following = np.roll(scan.ranges, -1)
    gaps = [np.sum(np.abs(scan.ranges - following) > t / 2) for t in range(1, 21)]
    quotients = np.minimum(scan.ranges, following) / np.maximum(scan.ranges, following)
    relative = [np.sum(quotients < t / 10) for t in range(1, 11)]
    return np.r_[harmonics[2:] / harmonics[1], gaps, relative]


def milliseconds(call: Callable[[], object], repeats: int) -> float:
    call()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return 1e3 * float(np.median(times))


def main() -> None:
    observations = scans()
    first = observations[0]
    group, full = LaserGeometry("group"), LaserGeometry("full")
    difference = np.abs(plain(first.scan)[:99] - group.extract(first)[29:128]).max()
    print(f"1 thread, {BEAMS} beams, largest difference of Fourier features {difference:.1e}")
    peer = milliseconds(lambda: plain(first.scan), 100)
    print(f"peer: NumPy, plainly, 129 of the features {peer:6.3f} ms a scan")
    for name, cue in (("group, 182", group), ("full, 165 ", full)):
        one = milliseconds(lambda cue=cue: cue.extract(first), 100)
        many = milliseconds(lambda cue=cue: cue.transform(observations), 5) / SCANS
        for how, ours in (("one scan", one), ("batches ", many)):
            print(f"placecue {name} features, {how}   {ours:6.3f} ms a scan, {peer / ours:.1f}x")


if __name__ == "__main__":
    main()
