"""What integration says of one observation."""

from __future__ import annotations

from collections.abc import Mapping
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
        The class that the scores' own rule picks; ``unknown`` where the pipeline has a threshold
        and the pick's confidence is below it.
    confidence : float
        How unambiguous that pick is, also where the label is ``unknown``; larger is surer.
    cue_scores : mapping of str to Scores
        The outputs of each cue that was extracted to get there, one row each.
    cues_missing : tuple of str
        The cues that the observation does not have, as far as is known.
    sharpness : float or None
        Log odds of a class by the unit of the scores, where training has measured it.
    agreement : float or None
        How often two cues say the same of samples that they were not trained on, where training
        has measured it.
    """

    stamp: int
    scores: Scores
    label: str
    confidence: float
    cue_scores: Mapping[str, Scores]
    cues_missing: tuple[str, ...] = ()
    sharpness: float | None = None
    agreement: float | None = None

    @property
    def cues_used(self) -> tuple[str, ...]:
        """The cues that were extracted to get there."""
        return tuple(self.cue_scores)
