"""An accumulator that is told everything again where the robot turns out to have been elsewhere."""

from __future__ import annotations

import numpy as np

from placecue import contracts
from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.correction import Correction
from placecue.estimator import clone
from placecue.guard import call
from placecue.observation import Observation
from placecue.semantic_map import SemanticMap
from placecue.slam.journal import Journal
from placecue.slam.planar import Array, array_of, between, compose, pose_of

#: Poses that have moved by less than this since the map was begun, m and rad, wait for the end.
ENOUGH, ENOUGH_TURN = 0.1, 0.05
#: With each new moment so many of those before are told again.
STEPS = 50


class Retold(Accumulator):
    """Makes the map of an accumulator that has known all along where the robot was.

    Where poses move, another copy of the accumulator is told everything again at the poses of now,
    some moments with each new one, and takes the place of the first when it has caught up. Until
    then the first goes on as if nothing had moved, so that its way has no jump. At the end of the
    log all is told again if anything has moved, so the map is that of a second reading. Areas may
    have other numbers then.

    Parameters
    ----------
    accumulator : Accumulator
        Makes the map. What is told again has no image.
    """

    def __init__(self, accumulator: Accumulator) -> None:
        self.accumulator = accumulator

    def reset(self) -> None:
        """Forget everything, as before the first observation."""
        self.journal_ = Journal()
        self.current_ = self._fresh()
        self.anew_: Accumulator | None = None  # what is told again
        self.told_ = 0  # how much of the journal it has been told
        self.off_ = np.zeros(2)  # m and rad that poses have moved since a map was begun
        self.stays_: dict[str, Array] = {}  # by frame, where the current map has a pose of now

    def update(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        """Take in the next observation; see :class:`placecue.Accumulator`."""
        self._begin()
        self.journal_.add(observation, belief)
        told = self._update(self.current_, self._stayed(observation), belief)
        if self.anew_ is not None:
            self._tell(STEPS)
        return told

    def corrected(self, correction: Correction) -> None:
        """Move what was told; where that is much, tell it again."""
        self._begin()
        self.journal_.move(correction)
        apart = correction.after - correction.before
        turns = np.abs((apart[:, 2] + np.pi) % (2 * np.pi) - np.pi)
        self.off_ += np.array([np.hypot(*apart[:, :2].T).max(), turns.max()])
        stays = self.stays_.get(correction.frame, np.zeros(3))
        # The current map goes on from where it had the last of these moments.
        back = compose(correction.before[-1], between(correction.after[-1], np.zeros(3)))
        self.stays_[correction.frame] = compose(stays, back)
        if self.off_[0] >= ENOUGH or self.off_[1] >= ENOUGH_TURN:
            self._tell_anew()

    def finish(self) -> None:
        """Tell everything again, if anything has moved since it was told."""
        self._begin()
        if self.off_.any():
            self._tell_anew()
        while self.anew_ is not None:
            self._tell(len(self.journal_))
        call(self.current_, "finish")

    def semantic_map(self) -> SemanticMap:
        """Return the map as it stands; after :meth:`finish` that of a second reading."""
        self._begin()
        made: SemanticMap = call(self.current_, "semantic_map", check=contracts.semantic_map)
        return made

    def warnings(self) -> list[str]:
        """Return what a person should know of the map, a line each."""
        self._begin()
        lines: list[str] = call(self.current_, "warnings", check=contracts.texts)
        return lines

    def check_parameters(self) -> None:
        """Raise UsageError if the accumulator's parameters cannot be what they are."""
        call(self.accumulator, "check_parameters")

    # ------------------------------------------------------------------ inside

    def _begin(self) -> None:
        if not hasattr(self, "journal_"):
            self.reset()

    def _fresh(self) -> Accumulator:
        made = clone(self.accumulator)
        call(made, "reset")
        return made

    def _tell_anew(self) -> None:
        self.anew_, self.told_, self.off_ = self._fresh(), 0, np.zeros(2)

    def _tell(self, most: int) -> None:
        """Tell some of the journal again, and take the new map when all is told."""
        assert self.anew_ is not None
        end = min(self.told_ + most, len(self.journal_))
        for number in range(self.told_, end):
            self._update(self.anew_, *self.journal_.read(number))
        self.told_ = end
        if end == len(self.journal_):
            self.current_, self.anew_, self.stays_ = self.anew_, None, {}

    def _update(
        self, to: Accumulator, observation: Observation, belief: Belief | None
    ) -> AreaUpdate | None:
        update: AreaUpdate | None = call(
            to, "update", observation, belief, check=contracts.area_update, at=observation
        )
        return update

    def _stayed(self, observation: Observation) -> Observation:
        """Return an observation where the current map has it, which knows of no correction."""
        pose = observation.pose
        if pose is None or pose.frame not in self.stays_:
            return observation
        placed = compose(self.stays_[pose.frame], array_of(pose))
        return observation.placed(pose_of(placed, pose.frame))
