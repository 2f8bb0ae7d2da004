"""A robot that follows a path, and what its wheels make of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from placecue_office.plan import Points


def follow(
    path: Points,
    speed: float,
    turn_rate: float = 1.2,
    lookahead: float = 0.25,
    step: float = 0.02,
) -> NDArray[np.float64]:
    """Drive along a path by pure pursuit, slower the more the robot has to turn.

    Parameters
    ----------
    path : ndarray, shape (n, 2)
        Evenly spaced points, m.
    speed : float
        Speed on a straight, m/s.
    turn_rate : float
        Fastest turn, rad/s.
    lookahead : float
        Distance of the point on the path that is steered at, m.
    step : float
        Time step, s.

    Returns
    -------
    ndarray, shape (k, 4)
        Time in s, x and y in m, heading in rad (unwrapped) at each step.
    """
    x, y = path[0]
    target, heading = 0, None
    states: list[tuple[float, float, float, float]] = []
    while True:
        while np.hypot(path[target, 0] - x, path[target, 1] - y) < lookahead:
            if target == len(path) - 1:
                return np.array(states)
            target += 1
        bearing = float(np.arctan2(path[target, 1] - y, path[target, 0] - x))
        heading = bearing if heading is None else heading
        states.append((len(states) * step, x, y, heading))
        off = (bearing - heading + np.pi) % (2 * np.pi) - np.pi
        heading += float(np.clip(off / (4 * step), -turn_rate, turn_rate)) * step
        advance = speed * step * max(0.0, float(np.cos(off))) ** 4
        x, y = x + advance * np.cos(heading), y + advance * np.sin(heading)


def sample(states: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return the states (k, 4) at ``rate`` a second, shape (n, 4)."""
    times = np.arange(0.0, states[-1, 0], 1.0 / rate)
    return np.column_stack([times, *(np.interp(times, states[:, 0], s) for s in states.T[1:])])


def odometry(
    poses: NDArray[np.float64], drift: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return where the wheels say that the robot is; it starts at the truth and drifts away.

    Parameters
    ----------
    poses : ndarray, shape (n, 3)
        True x, y in m and heading in rad.
    drift : float
        Size of the errors: every run has its own scale errors of distance and turning (standard
        deviation ``drift``), and each step a random one of ``drift`` times its length and turn,
        with 0.2 rad of heading for each metre.
    rng : Generator

    Returns
    -------
    ndarray, shape (n, 3)
        x, y and heading.
    """
    steps, turn = np.diff(poses[:, :2], axis=0), np.diff(poses[:, 2])
    ahead, aside = _turned(steps, -poses[:-1, 2]).T  # as the wheels feel them
    scales, shaky = drift * rng.standard_normal(2), drift * rng.standard_normal((3, len(turn)))
    stretch = 1 + scales[0] + shaky[0]
    slip = 0.2 * np.abs(ahead) * shaky[2]
    heading = poses[0, 2] + np.append(0.0, np.cumsum(turn * (1 + scales[1] + shaky[1]) + slip))
    felt = np.column_stack([ahead, aside]) * stretch[:, None]
    track = np.vstack([np.zeros(2), np.cumsum(_turned(felt, heading[:-1]), axis=0)])
    return np.column_stack([poses[0, :2] + track, heading])


def _turned(vectors: Points, angles: NDArray[np.float64]) -> Points:
    c, s = np.cos(angles), np.sin(angles)
    x, y = vectors.T
    return np.column_stack([c * x - s * y, s * x + c * y])
