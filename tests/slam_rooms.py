"""Rooms drawn as walls, scans of them by geometry, and drives with odometry that drifts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import pairwise

import numpy as np

from placecue import LaserScan, Observation, Pose2D, Source
from placecue.slam.planar import between, compose
from placecue.slam.straightened import Straightened

BEAMS = {180: np.radians(np.arange(-90, 90.5, 1.0)), 360: np.radians(np.arange(-180, 180, 2.0))}
BEAMS[270] = np.radians(np.arange(-135, 135.5, 1.5))

Wall = tuple[float, float, float, float]


def box(x0: float, y0: float, x1: float, y1: float) -> list[Wall]:
    """Return the four walls of a rectangle, m."""
    return [(x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0)]


def ring() -> list[Wall]:
    """Return a corridor 2 m wide around a block, with pillars so that no two places are alike."""
    pillars = [(3.0, 0.2), (8.5, 1.7), (11.5, 5.0), (10.3, 7.6), (6.0, 9.8), (2.2, 8.3), (0.2, 4.5)]
    walls = box(0, 0, 12, 10) + box(2, 2, 10, 8)
    for x, y in pillars:
        walls += box(x, y, x + 0.3, y + 0.3)
    return walls


def ranges(walls: list[Wall], pose: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Return the distance to the nearest wall along each beam; infinite where there is none."""
    x, y, theta = pose
    d = np.stack([np.cos(angles + theta), np.sin(angles + theta)], axis=1)[:, None]
    a = np.array(walls)[None, :, :2]
    s = np.array(walls)[None, :, 2:] - a
    to = a - [x, y]
    cross = d[..., 0] * s[..., 1] - d[..., 1] * s[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (to[..., 0] * s[..., 1] - to[..., 1] * s[..., 0]) / cross
        at = (to[..., 0] * d[..., 1] - to[..., 1] * d[..., 0]) / cross
    hit = (along > 0) & (at >= 0) & (at <= 1)
    return np.where(hit, along, np.inf).min(axis=1)


def scan(
    walls: list[Wall],
    pose: np.ndarray,
    angles: np.ndarray = BEAMS[180],
    mount: Pose2D | None = None,
    far: float = 20.0,
    noise: np.ndarray | float = 0.0,
) -> LaserScan:
    """Return what a scanner sees of walls from the robot's pose."""
    mount = Pose2D(0.0, 0.0, 0.0, "base_link") if mount is None else mount
    at = Pose2D(*pose).compose(mount)
    lengths = ranges(walls, np.array([at.x, at.y, at.theta]), angles) + noise
    return LaserScan(angles, np.where(lengths > far, np.inf, lengths), 0.05, far, mount)


def way(corners: list[tuple[float, float]], step: float = 0.1, turn: float = 0.2) -> np.ndarray:
    """Return poses along straight lines, turning on the spot at corners, shape (n, 3)."""
    poses: list[tuple[float, float, float]] = []
    heading = None
    for (x0, y0), (x1, y1) in pairwise(corners):
        towards = float(np.arctan2(y1 - y0, x1 - x0))
        if heading is not None:
            by = (towards - heading + np.pi) % (2 * np.pi) - np.pi
            for k in range(1, int(abs(by) / turn) + 1):
                poses.append((x0, y0, heading + np.sign(by) * k * turn))
        heading = towards
        for k in range(max(round(np.hypot(x1 - x0, y1 - y0) / step), 1)):
            poses.append(
                (x0 + k * step * np.cos(heading), y0 + k * step * np.sin(heading), heading)
            )
    return np.array(poses)


def drifting(poses: np.ndarray, stretch: float = 1.03, veer: float = 0.01) -> np.ndarray:
    """Return what wheels say that measure ways too long and veer by so many rad a metre."""
    told = [poses[0]]
    for a, b in pairwise(poses):
        dx, dy = b[:2] - a[:2]
        c, s = np.cos(a[2]), np.sin(a[2])
        ahead, aside = stretch * (c * dx + s * dy), stretch * (c * dy - s * dx)
        x, y, theta = told[-1]
        c, s = np.cos(theta), np.sin(theta)
        turn = (b[2] - a[2] + np.pi) % (2 * np.pi) - np.pi
        turn += veer * np.hypot(dx, dy)
        told.append(np.array([x + c * ahead - s * aside, y + s * ahead + c * aside, theta + turn]))
    return np.array(told)


def drive(
    walls: list[Wall],
    true: np.ndarray,
    odometry: np.ndarray | None,
    seconds: float = 0.2,
    noise: float = 0.01,
    **scanner: object,
) -> list[Observation]:
    """Return the observations of a drive; without odometry they have no pose."""
    rng = np.random.default_rng(7)
    angles = scanner.get("angles", BEAMS[180])
    made = []
    for number, pose in enumerate(true):
        seen = scan(walls, pose, noise=noise * rng.standard_normal(len(angles)), **scanner)
        told = None if odometry is None else Pose2D(*odometry[number].tolist())
        made.append(Observation(round(number * seconds * 1e9), scan=seen, pose=told))
    return made


#: Once around the block, and on past where it began.
ROUND = way([(1, 1), (11, 1), (11, 9), (1, 9), (1, 1), (6, 1)], step=0.2, turn=0.3)


@cache
def around_the_block() -> tuple[np.ndarray, list[Observation]]:
    """Return the odometry and the observations of a drive along :data:`ROUND`."""
    odometry = drifting(ROUND, stretch=1.03, veer=0.012)
    return odometry, drive(ring(), ROUND, odometry)


#: A room, and one elsewhere.
SHOP = [*box(0, 0, 7, 5), *box(0, 3.8, 1.4, 5), *box(5.6, 4, 7, 5), *box(3.2, 2.3, 3.8, 2.6)]
ELSEWHERE = [*box(100, 100, 103, 109), *box(101, 104, 101.4, 104.4)]


@cache
def carried_and_back() -> tuple[np.ndarray, list[Observation], int]:
    """Return a robot that is carried away and back: true poses, observations, how many are back.

    Its wheels notice nothing of it: by them it drives on. Back in the room it goes another way.
    """
    before = way([(1.5, 1.2), (5.2, 1.2), (5.2, 3.4), (2, 3.4), (2, 1.8)], step=0.25, turn=0.4)
    there = way([(102.2, 101.5), (102.2, 106.5)], step=0.25)
    back = way([(5, 3.2), (2.4, 3.2), (2.4, 1.2)], step=0.25, turn=0.4)
    true, by_wheels = np.vstack([before, there, back]), before
    for part in (there, back):
        moved = [compose(by_wheels[-1], between(part[0], pose)) for pose in part]
        by_wheels = np.vstack([by_wheels, moved])
    return true, drive(SHOP + ELSEWHERE, true, by_wheels, angles=BEAMS[360]), len(back)


class Driven(Source):
    """Observations as a source."""

    name = "drive"

    def __init__(self, observations: list[Observation]) -> None:
        self.observations = observations

    def __iter__(self) -> Iterator[Observation]:
        return iter(self.observations)

    def digest(self) -> str:
        return "drive"


@cache
def corrected_carried() -> tuple[Straightened, list[Observation]]:
    """Return the robot that is carried, with corrected poses, as they were told."""
    source = Straightened(Driven(carried_and_back()[1]))
    return source, list(source)


@cache
def corrected_round() -> tuple[Straightened, list[Observation]]:
    """Return that drive with corrected poses, and its observations as they were told."""
    source = Straightened(Driven(around_the_block()[1]))
    return source, list(source)
