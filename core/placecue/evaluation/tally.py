"""Counts how often each class was taken for which, by every cue and by the whole pipeline."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import Any

from placecue.accumulator import AreaUpdate
from placecue.belief import Belief
from placecue.observation import Observation
from placecue.semantic_map import UNKNOWN

INTEGRATED = "integrated"


class Tally:
    """Confusion counts of a labelled log; a listener.

    "unknown" is a label like any other: it is not the class, so it is no recognition.

    Attributes
    ----------
    says_unknown : bool
        Whether the pipeline can say "unknown"; set by who knows the pipeline.
    counts : dict of str to Counter
        For each method (a cue, or ``integrated``) how often (truth, predicted) came up.
    used, missing : Counter of str
        At how many observations with a belief each cue was asked, and at how many it was not there.
    believed, unlabelled, unusable : int
        Observations with a belief; without a label; with a label but without a belief.
    """

    def __init__(self) -> None:
        self.says_unknown = False
        self.counts: dict[str, Counter[tuple[str, str]]] = defaultdict(Counter)
        self.used: Counter[str] = Counter()
        self.missing: Counter[str] = Counter()
        self.believed = 0
        self.unlabelled = 0
        self.unusable = 0

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Count one observation."""
        if belief is not None:
            self.believed += 1
            self.used.update(belief.cues_used)
            self.missing.update(belief.cues_missing)
        if observation.label is None:
            self.unlabelled += 1
        elif belief is None:
            self.unusable += 1
        else:
            self._count(observation.label, belief)

    def _count(self, truth: str, belief: Belief) -> None:
        for cue, scores in belief.cue_scores.items():
            self.counts[cue][truth, str(scores.decide().labels[0])] += 1
        self.counts[INTEGRATED][truth, belief.label] += 1

    @property
    def methods(self) -> list[str]:
        """The cues, where there are two or more, and ``integrated`` last.

        A cue is counted wherever it was asked.
        """
        cues = [method for method in self.counts if method != INTEGRATED]
        return (cues if len(cues) > 1 else []) + ([INTEGRATED] if self.counts else [])

    def classes(self) -> list[str]:
        """Return the classes that occur as truth, sorted."""
        return sorted({truth for counter in self.counts.values() for truth, _ in counter})

    def samples(self, truth: str) -> int:
        """Return how many samples of a class the pipeline decided on."""
        counter = self.counts[INTEGRATED]
        return sum(count for (name, _), count in counter.items() if name == truth)

    def recall(self, method: str, truth: str) -> float | None:
        """Return the share of a class that a method recognised; None if it saw none of it."""
        return self._share(method, truth, truth)

    def unknown(self, method: str, truth: str | None = None) -> float | None:
        """Return the share of a class (of all by default) that a method called unknown."""
        return self._share(method, truth, UNKNOWN)

    def accuracy_of_named(self, method: str) -> float | None:
        """Return the share of right ones among decisions that name a class; None without any."""
        named = {pair: n for pair, n in self.counts[method].items() if pair[1] != UNKNOWN}
        right = sum(count for (truth, predicted), count in named.items() if truth == predicted)
        return right / sum(named.values()) if named else None

    def balanced_accuracy(self, method: str) -> float:
        """Return the mean of the per-class recalls, the paper's score."""
        recalls = [self.recall(method, truth) for truth in self.classes()]
        known = [recall for recall in recalls if recall is not None]
        return sum(known) / len(known)

    def to_json(self) -> dict[str, Any]:
        """Return the scores as plain data."""
        return {
            "unlabelled": self.unlabelled,
            "unusable": self.unusable,
            "beliefs": self.believed,
            "cues_used": dict(self.used),
            "cues_missing": dict(self.missing),
            "methods": {
                method: {
                    "balanced_accuracy": self.balanced_accuracy(method),
                    "recall": {truth: self.recall(method, truth) for truth in self.classes()},
                    "unknown": self.unknown(method),
                    "accuracy_of_named": self.accuracy_of_named(method),
                    "confusion": [
                        {"truth": truth, "predicted": predicted, "count": count}
                        for (truth, predicted), count in sorted(self.counts[method].items())
                    ],
                }
                for method in self.methods
            },
        }

    def _share(self, method: str, truth: str | None, predicted: str) -> float | None:
        """Return how much of a class, or of all, a method took for another."""
        of_class = Counter[str]()
        for (name, said), count in self.counts[method].items():
            if truth in (None, name):
                of_class[said] += count
        return of_class[predicted] / of_class.total() if of_class else None
