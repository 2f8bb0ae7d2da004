"""What integration says of one observation."""

from __future__ import annotations

from dataclasses import dataclass

from placecue.scores import Scores


@dataclass(frozen=True, slots=True)
class Belief:
    """What integration says of one observation.

    Parameters
    ----------
    stamp : int
        Time of the observation, ns.
    scores : Scores
        The integrated outputs, one row.
    label : str
        The class that the scores' own rule picks.
    confidence : float
        How unambiguous that pick is; larger is surer.
    cues_used : tuple of str
        The cues that were extracted to get there.
    """

    stamp: int
    scores: Scores
    label: str
    confidence: float
    cues_used: tuple[str, ...]
