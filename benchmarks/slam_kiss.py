"""KISS-ICP, the maintained odometry of 3D scanners, on 2D scans: what is not made for them.

    python benchmarks/slam_kiss.py SCANS.npz POSES.npy     (in an environment with kiss-icp)

``slam_kiss_data.py`` writes SCANS.npz and judges POSES.npy: the two packages need not be installed
beside one another. Each scan is three layers of points, so that walls have a height.
"""

from __future__ import annotations

import sys
import time
from itertools import pairwise

import numpy as np
from kiss_icp.config import KISSConfig
from kiss_icp.kiss_icp import KissICP

LAYERS = (-0.06, 0.0, 0.06)


def main(scans: str, out: str) -> None:
    data = np.load(scans)
    points, starts = data["points"], data["starts"]
    config = KISSConfig()
    config.data.max_range, config.data.min_range, config.data.deskew = 25.0, 0.1, False
    config.mapping.voxel_size = 0.2
    method, poses, begun = KissICP(config), [], time.process_time()
    for start, end in pairwise(starts):
        flat = points[start:end]
        frame = np.vstack([np.column_stack([flat, np.full(len(flat), z)]) for z in LAYERS])
        method.register_frame(frame, np.zeros(len(frame)))
        pose = method.last_pose
        poses.append([pose[0, 3], pose[1, 3], np.arctan2(pose[1, 0], pose[0, 0])])
    print(f"{len(poses) / (time.process_time() - begun):.0f} scans a second")
    np.save(out, np.array(poses))


if __name__ == "__main__":
    main(*sys.argv[1:])
