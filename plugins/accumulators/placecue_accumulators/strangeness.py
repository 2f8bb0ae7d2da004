"""How strange a building is to a model: by how much less its cues agree than in training."""

from __future__ import annotations

from placecue.agreement import agreeing, log_odds_lost
from placecue.belief import Belief
from placecue_accumulators.histogram import Key

#: Before anything is seen, cues are taken to have agreed as in training on so many pairs.
BEFORE = 20
#: Log odds shrink by no more than this, which is what they were worth in the building of the tuning
#: half (docs/labelling.md): joined, cues know more than each alone.
MOST = 3.0
#: Where there is one cue nothing tells how strange a building is: they shrink by this.
ALONE = 2.0
#: From so many times smaller log odds on a building is called strange.
STRANGE = 1.5


class Strangeness:
    """Counts how often the cues of a drive agree, once a viewpoint.

    Parameters
    ----------
    known : float or None
        How often two cues agreed on held-out training samples; None where there is one cue, or
        nothing was measured.
    classes : int
        How many there are.
    otherwise : float
        The factor where agreement is not known.
    """

    def __init__(self, known: float | None, classes: int, otherwise: float = 1.0) -> None:
        self.known = known
        self.classes = classes
        self.otherwise = otherwise
        self.alike = self.pairs = 0
        self._last: Key | None = None

    def hear(self, belief: Belief, viewpoint: Key) -> None:
        """Take in what the cues of an observation say."""
        if self.known is None or viewpoint == self._last or len(belief.cue_scores) < 2:
            return
        self._last = viewpoint
        labels = [str(each.decide().labels[0]) for each in belief.cue_scores.values()]
        alike, pairs = agreeing(labels)
        self.alike, self.pairs = self.alike + alike, self.pairs + pairs

    @property
    def agreement(self) -> float | None:
        """How often two cues agree here, begun from how often they do; None where it is unknown."""
        if self.known is None:
            return None
        return (self.alike + BEFORE * self.known) / (self.pairs + BEFORE)

    @property
    def factor(self) -> float:
        """By how much log odds are smaller here, from 1 to ``MOST``."""
        here = self.agreement
        if self.known is None or here is None:
            return self.otherwise
        return min(log_odds_lost(self.known, here, self.classes), MOST)

    def lines(self) -> list[str]:
        """Return what a person should know, a line each."""
        if self.known is None or self.factor < STRANGE:
            return []
        share = self.alike / self.pairs
        return [
            f"the cues say the same of {100 * share:.0f} % of the observations, where on held-out "
            f"training samples it was {100 * self.known:.0f} %: the building is strange to the "
            "model, and its labels are less sure; train on samples of it (placecue teach)"
        ]
