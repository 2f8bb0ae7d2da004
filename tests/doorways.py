"""A doorway between two rooms, and what a scanner sees there."""

import numpy as np

from placecue import LaserScan, Pose2D


def doorway(width=0.8, depth=(-0.1, 0.1), far=4.0):
    """Return segments (x1, y1, x2, y2): a wall along y with a doorway at the origin, two rooms."""
    near, behind, half = depth[0], depth[1], width / 2
    walls = [(-far, -5, -far, 5), (far, -5, far, 5), (-far, 5, far, 5), (-far, -5, far, -5)]
    for side in (-1, 1):
        walls.append((near, side * half, behind, side * half))
        walls += [(x, side * half, x, side * 5) for x in depth]
    return np.array(walls, dtype=float)


def ranges_of(walls, pose, bearings):
    """Cast rays against segments: the textbook solution of o + t d = a + s (b - a)."""
    d = np.stack([np.cos(bearings + pose.theta), np.sin(bearings + pose.theta)], axis=1)
    a, e = walls[:, :2], walls[:, 2:] - walls[:, :2]
    ao = a - np.array([pose.x, pose.y])
    cross = d[:, None, 0] * e[None, :, 1] - d[:, None, 1] * e[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (ao[:, 0] * e[:, 1] - ao[:, 1] * e[:, 0])[None] / cross
        s = (ao[None, :, 0] * d[:, None, 1] - ao[None, :, 1] * d[:, None, 0]) / cross
    hit = (t > 0) & (s >= -1e-9) & (s <= 1 + 1e-9) & (np.abs(cross) > 1e-12)
    return np.where(hit, t, np.inf).min(axis=1)


def scan_at(walls, pose, beams=361, field=180.0, mount=None):
    mount = mount or Pose2D(0, 0, 0, "base_link")
    angles = np.radians(np.linspace(-field / 2, field / 2, beams))
    return LaserScan(angles, ranges_of(walls, pose.compose(mount), angles), 0.01, 30.0, mount)
