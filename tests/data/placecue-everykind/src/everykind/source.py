"""A source."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, radians, sin

import numpy as np

from placecue import LaserScan, Observation, Pose2D, Source

ROOMS = {
    "corridor": (24.0, 2.0),
    "hall": (20.0, 18.0),
    "kitchen": (4.0, 4.0),
    "lab": (9.0, 7.0),
}
ANGLES = np.radians(np.linspace(-90, 90, 61))


class Boxes(Source):
    """A robot in four bare rooms in turn, 40 m apart, five scans a second.

    Parameters
    ----------
    stay : int
        Scans of each visit.
    rounds : int
        How often all rooms are visited.
    seed : int
        Where in the rooms the robot is, and noise.
    """

    def __init__(self, stay: int = 8, rounds: int = 2, seed: int = 0) -> None:
        self.stay = stay
        self.rounds = rounds
        self.seed = seed
        self.name = f"boxes {seed}"

    def __iter__(self) -> Iterator[Observation]:
        for number in range(self.stay * self.rounds * len(ROOMS)):
            generator = np.random.default_rng((self.seed, number))
            room = number // self.stay % len(ROOMS)
            label, (length, width) = list(ROOMS.items())[room]
            heading = radians(generator.normal(0, 10))
            yield Observation(
                1_700_000_000_000_000_000 + number * 200_000_000,
                scan=LaserScan(ANGLES, ranges(length, width, heading, generator), 0.0, 30.0),
                pose=Pose2D(40.0 * room + 5 * cos(heading), 5 * sin(heading), heading),
                label=label,
            )

    def digest(self) -> str:
        """Return what tells one recording from another."""
        return f"boxes-{self.stay}-{self.rounds}-{self.seed}"


def ranges(
    length: float, width: float, heading: float, generator: np.random.Generator
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return what a scanner in the middle of a rectangle sees, m."""
    with np.errstate(divide="ignore"):
        ends = np.abs(length / 2 / np.cos(ANGLES + heading))
        sides = np.abs(width / 2 / np.sin(ANGLES + heading))
    seen = np.minimum(ends, sides) + 0.01 * generator.normal(size=ANGLES.size)
    return np.asarray(seen, dtype=np.float64)
