"""Scans for benchmarks/slam_kiss.py, and evo's error of the poses that it comes to.

python benchmarks/slam_kiss_data.py freiburg-079 SCANS.npz        writes the scans
python benchmarks/slam_kiss_data.py freiburg-079 POSES.npy        prints the error
"""

from __future__ import annotations

import sys

import numpy as np
from slam_drives import carmen_drive
from slam_page import ape


def main(name: str, path: str) -> None:
    drive = carmen_drive(name)
    if path.endswith(".npz"):
        clouds = [each.scan.points() for each in drive.observations]
        starts = np.cumsum([0, *map(len, clouds)])
        np.savez(path, points=np.vstack(clouds), starts=starts)
    else:
        print(ape(drive.stamps, np.load(path), drive.true))


if __name__ == "__main__":
    main(*sys.argv[1:])
