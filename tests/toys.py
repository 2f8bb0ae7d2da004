"""Small cues and observations that tests share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from placecue import Component, Cue, LaserScan, Observation, Pipeline, Pose2D, Source
from placecue.components.manager import load_plugins
from placecue.components.registry import Registry
from placecue.scaling import RangeScaling
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF

PLACES = ("corridor", "kitchen", "lab", "office")
SECOND = 1_000_000_000


class Beams(Cue):
    """The first few beams."""

    requires = ("scan",)

    def __init__(self, count: int = 4) -> None:
        self.count = count

    def extract(self, observation: Observation) -> np.ndarray:
        return observation.scan.filled()[: self.count]


class Brightness(Cue):
    """Mean colour of the image, less the mean over the training images."""

    requires = ("image",)
    learns = True

    def fit(self, observations: Iterable[Observation], labels: object = None) -> Brightness:
        means = [self._mean(observation) for observation in observations]
        self.center_ = np.mean(means, axis=0)
        self.seen_ = len(means)
        return self

    def extract(self, observation: Observation) -> np.ndarray:
        return self._mean(observation) - self.center_

    @staticmethod
    def _mean(observation: Observation) -> np.ndarray:
        return observation.image.mean(axis=(0, 1))


class Walk(Source):
    """A robot that stays a while in each of four places, some rounds long."""

    def __init__(self, rounds: int = 4, stay: int = 20, seed: int = 0, noise: float = 0.4) -> None:
        self.rounds, self.stay, self.seed, self.noise = rounds, stay, seed, noise
        self.name = f"walk {seed}"

    def __iter__(self) -> Iterator[Observation]:
        for number in range(self.count()):
            yield self.at(number)

    def at(self, number: int) -> Observation:
        generator = np.random.default_rng((self.seed, number))
        place = number // self.stay % len(PLACES)
        ranges = 2.0 + place + self.noise * generator.normal(size=6)
        scan = LaserScan(np.linspace(-1, 1, 6), np.abs(ranges), 0.0, 20.0)
        colour = np.array([60, 60 + 20 * place, 150 - 30 * place]) + generator.integers(-9, 9, 3)
        image = np.broadcast_to(colour.astype(np.uint8), (4, 5, 3))
        pose = Pose2D(0.1 * number, float(place), 0.0)
        stamp = number * SECOND // 5
        return Observation(stamp, image=image, scan=scan, pose=pose, label=PLACES[place])

    def count(self) -> int:
        return self.rounds * self.stay * len(PLACES)

    def digest(self) -> str:
        return f"walk-{self.rounds}-{self.stay}-{self.seed}-{self.noise}"


def registry() -> Registry:
    """The built-ins and the toys."""
    found = load_plugins(built_ins_only=True).registry
    toys = [
        Component("cue", "beams", "toys:Beams"),
        Component("cue", "brightness", "toys:Brightness"),
        Component("source", "walk", "toys:Walk"),
    ]
    found.add(toys, "toys", "1.0")
    return found


def pipeline() -> Pipeline:
    """Two cues, one of which learns, and SVM-DAS; unfitted."""
    return Pipeline(
        cues={
            "beams": (Beams(), SVM(kernel=RBF(gamma=0.1), multiclass="oao")),
            "brightness": (Brightness(), SVM(kernel=RBF(gamma=0.001), scaling=RangeScaling())),
        },
        integrator=SVMDAS(classifier=SVM(kernel=RBF(gamma=0.3), multiclass="oao")),
    )
