"""Mistakes of a run in one pass: a bounded sample of them, which no chance is in."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.evaluation.report.mistakes import Bar, Mistake, Mistakes, Scored
from placecue.evaluation.report.views import view
from placecue.evaluation.tally import INTEGRATED
from placecue.observation import Observation
from placecue.scores import Scores

#: Classes whose scores are shown besides the true one.
CLASSES = 5


@dataclass
class _Kept:
    """Every so-many-th mistake of a kind."""

    met: int = 0
    stride: int = 1
    mistakes: list[Mistake] = field(default_factory=list)

    def thin(self) -> None:
        """Let every other one go, and keep half as many from now on."""
        self.mistakes = self.mistakes[::2]
        self.stride *= 2


class MistakeSample:
    """Keeps a few mistakes of each kind (what was taken for what), evenly over time; a listener.

    Pictures are kept as small JPEGs, so memory stays small however long the log is.

    Parameters
    ----------
    most : int
        So many mistakes at most.
    each : int
        So many of a kind.
    """

    def __init__(self, most: int = 150, each: int = 8) -> None:
        self.most = most
        self.each = each
        self._kinds: dict[tuple[str, str], _Kept] = defaultdict(_Kept)
        self.total = 0

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Look at one observation."""
        truth = observation.label
        if belief is None or truth is None or belief.label == truth:
            return
        self.total += 1
        kind = self._kinds[truth, belief.label]
        kind.met += 1
        if (kind.met - 1) % kind.stride == 0 and self._has_room(kind):
            kind.mistakes.append(_mistake(observation, belief, truth))
            if len(kind.mistakes) > self.each:
                kind.thin()

    @property
    def mistakes(self) -> Mistakes:
        """What was kept, by class, what it was taken for, and time."""
        kinds = [self._kinds[key].mistakes for key in sorted(self._kinds)]
        return Mistakes([each for kind in kinds for each in kind], self.total)

    def _has_room(self, kind: _Kept) -> bool:
        while sum(len(each.mistakes) for each in self._kinds.values()) >= self.most:
            fullest = max(self._kinds.values(), key=lambda each: len(each.mistakes))
            if len(fullest.mistakes) < 2:
                return False
            fullest.thin()
        return (kind.met - 1) % kind.stride == 0


def _mistake(observation: Observation, belief: Belief, truth: str) -> Mistake:
    image, scan = view(observation)
    said: dict[str, list[str]] = defaultdict(list)
    if len(belief.cue_scores) > 1:
        for cue, scores in belief.cue_scores.items():
            said[str(scores.decide().labels[0])].append(cue)
    said[belief.label].append(INTEGRATED)
    parts = dict(belief.cue_scores)
    if len(parts) > 1:
        parts[INTEGRATED] = belief.scores
    bars = [_scored(name, scores, truth) for name, scores in parts.items()]
    return Mistake(
        observation.log_name,
        observation.stamp,
        truth,
        belief.label,
        belief.confidence,
        INTEGRATED,
        said=said,
        scores=bars,
        image=image,
        scan=scan,
    )


def _scored(name: str, scores: Scores, truth: str) -> Scored:
    """Return the scores of the best classes, and of the true one."""
    layout = scores.layout
    names, values = list(layout.columns), scores.values[0]
    if set(names) != set(layout.classes):  # columns of pairs, or of some classes
        name = f"{name}, ranks"
        names, values = list(layout.classes), layout.preference(scores.values)[0]
    if not np.isfinite(values).all():
        return Scored(name, ())
    low = min(float(values.min()), 0.0)
    reach = max(float(values.max()) - low, 1e-12)
    order = np.argsort(-values, kind="stable")
    shown = [at for place, at in enumerate(order) if place < CLASSES or names[at] == truth]
    bars = (
        Bar(names[at], float(values[at]), (float(values[at]) - low) / reach, names[at] == truth)
        for at in shown
    )
    return Scored(name, tuple(bars))
