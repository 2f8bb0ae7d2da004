"""A robot in four rooms of different shape and wallpaper: small logs that a second trains on."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from placecue import LaserScan, Observation, Pose2D, Source
from placecue.logs.writing.writer import McapWriter
from placecue.observation import EncodedImage

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
#: Length and width of each room, m, and the wavelength of its wallpaper, pixels.
ROOMS = {
    "corridor": (24.0, 2.0, 3.0),
    "kitchen": (4.0, 4.0, 6.0),
    "lab": (9.0, 7.0, 12.0),
    "office": (3.0, 5.0, 24.0),
}
ANGLES = np.radians(np.linspace(-90, 90, 61))
RANGE_MAX = 30.0


class Rooms(Source):
    """Visits the four rooms in turn, five observations a second.

    Parameters
    ----------
    rounds : int
        How often all rooms are visited.
    stay : int
        Observations of each visit.
    seed : int
        Noise, and where in the rooms the robot is.
    """

    def __init__(self, rounds: int = 2, stay: int = 12, seed: int = 0) -> None:
        self.rounds = rounds
        self.stay = stay
        self.seed = seed
        self.name = f"rooms {seed}"

    def __iter__(self) -> Iterator[Observation]:
        return map(self.at, range(self.count()))

    def at(self, number: int) -> Observation:
        """Return one observation; the rooms stand in a row, 30 m apart."""
        generator = np.random.default_rng((self.seed, number))
        room = number // self.stay % len(ROOMS)
        label = list(ROOMS)[room]
        length, width, wavelength = ROOMS[label]
        x, y = generator.uniform(-0.3, 0.3, 2) * (length, width)
        along = length * ((number % self.stay + 0.5) / self.stay - 0.5)
        theta = 0.2 * generator.normal()
        return Observation(
            START + number * SECOND // 5,
            image=EncodedImage(picture(wavelength, generator), "png"),
            scan=scan(length, width, float(x), float(y), theta, generator),
            pose=Pose2D(30.0 * room + along, 0.0, theta),
            label=label,
        )

    def count(self) -> int:
        return self.rounds * self.stay * len(ROOMS)

    def digest(self) -> str:
        return f"rooms-{self.rounds}-{self.stay}-{self.seed}"


def picture(wavelength: float, generator: np.random.Generator) -> bytes:
    """Return stripes of a wavelength with noise, 64 x 48, as PNG."""
    columns, rows = np.meshgrid(np.arange(64), np.arange(48))
    phase, slope = generator.uniform(0, 2 * np.pi), generator.uniform(0.2, 0.4)
    stripes = 128 + 60 * np.sin(2 * np.pi * (columns + slope * rows) / wavelength + phase)
    noisy = stripes + generator.normal(0, 4, stripes.shape)
    _, data = cv2.imencode(".png", np.clip(noisy, 0, 255).astype(np.uint8))
    return data.tobytes()


def scan(
    length: float,
    width: float,
    x: float,
    y: float,
    theta: float,
    generator: np.random.Generator,
) -> LaserScan:
    """Return what a scanner at (x, y) sees in a bare rectangle around the origin."""
    c, s = np.cos(ANGLES + theta), np.sin(ANGLES + theta)
    with np.errstate(divide="ignore"):
        ends = np.abs((np.sign(c) * length / 2 - x) / c)
        sides = np.abs((np.sign(s) * width / 2 - y) / s)
    ranges = np.minimum(ends, sides) + 0.01 * generator.normal(size=ANGLES.size)
    return LaserScan(ANGLES, ranges, 0.05, RANGE_MAX)


def write_log(path: Path, observations: Source | list[Observation], encoding: str = "cdr") -> Path:
    """Write observations as MCAP."""
    with McapWriter(path, encoding=encoding) as writer:
        for observation in observations:
            writer.write(observation)
    return path
