"""An area ends where the beliefs change."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import Boundary
from placecue.checks import check_number
from placecue.distribution import doubted
from placecue.observation import Observation, Pose2D

Values = NDArray[np.float64]

#: Two sums of the same steps differ by less, m.
ROUNDING = 1e-6


@dataclass(slots=True)
class Stretch:
    """A short stretch of the way, and what was believed there.

    Parameters
    ----------
    total : ndarray of float64, shape (M,)
        Log-likelihoods of each class, summed.
    count : int
        Of how many beliefs.
    begin : float
        Where it begins, m of way.
    """

    total: Values
    count: int
    begin: float


def best_cut(likelihoods: Values, shortest: int, known: Values | None = None) -> tuple[int, float]:
    """Find where a row of stretches is best cut into two places.

    Parameters
    ----------
    likelihoods : ndarray of float64, shape (n, M)
        Log-likelihood of each class on each stretch.
    shortest : int
        A place has at least so many stretches.
    known : ndarray of float64, shape (M,), optional
        Log-likelihood of each class by what was seen of the first place before, which then may
        have fewer stretches.

    Returns
    -------
    (int, float)
        The first stretch of the second place, and the logarithm of the likelihood of two places,
        each of its best class, against one; (0, 0) where the row is too short.
    """
    cuts = np.arange(shortest if known is None else 0, len(likelihoods) - shortest + 1)
    if not len(cuts):
        return 0, 0.0
    first = np.zeros(likelihoods.shape[1]) if known is None else known
    sums = np.vstack([first, first + likelihoods.cumsum(axis=0)])
    before, after = sums[cuts], sums[-1] - sums[cuts]
    gains = before.max(axis=1) + after.max(axis=1) - sums[-1].max()
    best = int(gains.argmax())
    return int(cuts[best]), float(gains[best])


class ChangedEvidence(Boundary):
    """A change point in the stream of beliefs: two places explain the last metres better than one.

    Beliefs are averaged over stretches of ``step``, so that how long the robot stands counts for
    nothing. After each stretch the likelihood of two places over the last ``window``, cut
    wherever it is best, is compared with that of one. It needs no laser.

    Parameters
    ----------
    window : float
        How far back a change is looked for, m of way.
    shortest : float
        The shortest place, m of way; a change is noticed no sooner after it.
    step : float
        Length of a stretch, m of way.
    threshold : float
        Logarithm of the likelihood ratio that convinces.
    rejoin : float
        Two areas that the robot goes straight between are one again where that of what was seen in
        each is no larger than this.
    independent : float
        The share of what a stretch says that its neighbours have not said already, 0 to 1.
    doubt : float
        The share of beliefs that may say anything, 0 to 1.

    Notes
    -----
    A change is noticed before ``window`` metres after it, and put where it was; one that is
    noticed sooner than after ``shortest`` is put so much before where that is.
    The likelihood ratio of a change at an unknown place is Page's (Biometrika 41, 1954).
    """

    gateway = False

    def __init__(
        self,
        window: float = 4.0,
        shortest: float = 0.8,
        step: float = 0.2,
        threshold: float = 2.0,
        rejoin: float = 0.0,
        independent: float = 0.7,
        doubt: float = 0.1,
    ) -> None:
        self.window = window
        self.shortest = shortest
        self.step = step
        self.threshold = threshold
        self.rejoin = rejoin
        self.independent = independent
        self.doubt = doubt

    def check_parameters(self) -> None:
        """Raise UsageError if a length is not positive or a share not between 0 and 1."""
        check_number("step", self.step, above=0)
        check_number("shortest", self.shortest, least=self.step)
        check_number("window", self.window, least=2 * self.shortest)
        check_number("threshold", self.threshold, above=0)
        check_number("rejoin", self.rejoin, least=0)
        check_number("independent", self.independent, above=0, most=1)
        check_number("doubt", self.doubt, above=0, below=1)

    @property
    def delay(self) -> float:
        """The window."""
        return self.window

    def reset(self) -> None:
        """Forget the way and the beliefs."""
        self.check_parameters()
        self.way_ = 0.0
        self.pose_: Pose2D | None = None
        self.stretches_: deque[Stretch] = deque()
        self.known_: Values | None = None  # by what was seen in this area on earlier visits

    def update(self, observation: Observation) -> Pose2D | None:
        """Measure the way; return None."""
        if not hasattr(self, "stretches_"):
            self.reset()
        pose, last = observation.pose, self.pose_
        if pose is not None:
            if last is not None:
                self.way_ += hypot(pose.x - last.x, pose.y - last.y)
            self.pose_ = pose
        return None

    def believe(self, observation: Observation, probabilities: Values) -> float | None:
        """Return how far behind the beliefs changed, m of way, or None."""
        if not hasattr(self, "stretches_"):
            self.update(observation)
        likelihood = np.log(doubted(probabilities, self.doubt))
        if self.stretches_ and self.way_ - self.stretches_[-1].begin < self.step - ROUNDING:
            self.stretches_[-1].total += likelihood
            self.stretches_[-1].count += 1
            return None
        cut = self._cut()
        self.stretches_.append(Stretch(likelihood.copy(), 1, self.way_))
        return cut

    def enter(self) -> None:
        """Begin anew: what was before belongs to another area."""
        if hasattr(self, "stretches_"):
            self.stretches_.clear()
            self.known_ = None

    def recall(self, likelihoods: Values) -> None:
        """Take note of what was seen in the area on earlier visits."""
        if hasattr(self, "stretches_"):
            self.known_ = likelihoods

    def joins(self, one: Values, other: Values) -> bool:
        """Tell whether two places are hardly likelier than one."""
        gain = one.max() + other.max() - (one + other).max()
        return bool(gain <= self.rejoin)

    def _cut(self) -> float | None:
        while self.stretches_ and self.way_ - self.stretches_[0].begin > self.window:
            self.stretches_.popleft()
        if not self.stretches_:
            return None
        rows = np.array([each.total / each.count for each in self.stretches_])
        shortest = round(self.shortest / self.step)
        first, gain = best_cut(rows * self.independent, shortest, self.known_)
        if gain < self.threshold:
            return None
        self.known_ = None
        begin = self.stretches_[first].begin
        for _ in range(first):
            self.stretches_.popleft()
        return self.way_ - begin
