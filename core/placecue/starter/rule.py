"""How the starter joins laser and objects."""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.evidence import Evidence
from placecue.integrator import Integrator
from placecue.scores import Probabilities, Scores
from placecue.starter.places import BY_LASER, CORRIDOR, ROOM, Places

Matrix = NDArray[np.float64]

LASER, OBJECTS = "laser", "objects"


class LaserThenObjects(Integrator):
    """The laser decides whether it is a corridor, a doorway or a room, objects which kind of room.

    With L the laser's probabilities and O those by objects, R the kinds of rooms and L(R) what
    the laser gives to rooms in all:

    - corridor and doorway keep L; kind k gets L(R) O(k) / max over R of O. So the place that wins
      is a room exactly where the laser says so, and then the kind that objects say.
    - These are scaled to sum to 1, and then mixed with what says nothing (all places equal):
      w p + (1 - w) / M with w = (1 + a) / 2, where a is the share that objects give to what the
      laser says: O(corridor) where it says corridor, 1 - O(corridor) where room, 1 where doorway,
      or where objects know of no corridor. The order stays, and the lead of the winner is halved
      where they disagree altogether.
    - Where one of the two is missing, the other decides alone.

    Parameters
    ----------
    places : Places
        The places, which are the classes of both cues.
    """

    gaps: ClassVar[bool] = True

    def __init__(self, places: Places) -> None:
        self.places = places

    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Learn nothing: the rule is fixed."""
        return self

    def integrate(self, evidence: Evidence) -> Scores:
        """Return the probabilities of n observations, shape (n, M)."""
        nothing = np.full((len(evidence), len(self.places.classes)), np.nan)
        told = {cue: evidence.scores(cue).values for cue in evidence.cues}
        laser, objects = told.get(LASER, nothing), told.get(OBJECTS, nothing)
        joined = np.where(np.isnan(laser), objects, laser)
        both = np.flatnonzero(~np.isnan(laser).any(axis=1) & ~np.isnan(objects).any(axis=1))
        joined[both] = self.joined(laser[both], objects[both])
        return Scores(joined, Probabilities(self.places.classes))

    def joined(self, laser: Matrix, objects: Matrix) -> Matrix:
        """Return the probabilities by both, shape (n, M)."""
        decided = self.places.columns(BY_LASER)
        kinds = self.places.columns(self.places.kinds)
        if not kinds:
            return laser
        rooms = [*kinds, *self.places.columns([ROOM])]
        room, best = laser[:, rooms].sum(axis=1), objects[:, kinds].max(axis=1)
        joined = np.zeros_like(laser)
        joined[:, decided] = laser[:, decided]
        share = np.ones((len(laser), len(kinds)))
        np.divide(objects[:, kinds], best[:, None], out=share, where=best[:, None] > 0)
        joined[:, kinds] = room[:, None] * share
        joined /= joined.sum(axis=1, keepdims=True)
        weight = (1 + self._agreement(laser, objects, rooms)) / 2
        return np.asarray(weight[:, None] * joined + (1 - weight[:, None]) / laser.shape[1])

    def _agreement(self, laser: Matrix, objects: Matrix, rooms: list[int]) -> Matrix:
        """Return the share that objects give to what the laser says, shape (n,)."""
        corridor = self.places.columns([CORRIDOR])
        if not corridor:
            return np.ones(len(laser))
        seen, said = objects[:, corridor[0]], laser[:, corridor[0]]
        room = laser[:, rooms].sum(axis=1)
        doorway = 1 - said - room
        agreement = np.where(said >= room, seen, 1 - seen)
        return np.where((seen == 0) | (doorway > np.maximum(said, room)), 1.0, agreement)
