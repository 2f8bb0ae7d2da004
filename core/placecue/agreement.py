"""How often cues agree: what can be known, without any label, of how right they are."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import log, sqrt

#: Accuracies are kept so far from chance and from certainty.
MARGIN = 0.02


def agreeing(labels: Sequence[str]) -> tuple[int, int]:
    """Return how many pairs of cues say the same, and how many pairs there are.

    Parameters
    ----------
    labels : sequence of str
        What each cue alone says of one observation.
    """
    pairs = list(combinations(labels, 2))
    return sum(one == other for one, other in pairs), len(pairs)


def accuracy_of(agreement: float, classes: int) -> float:
    """Return how often each of two cues is right that agree so often.

    Both are taken to be right equally often, to err independently of one another, and to take
    what they mistake for each other class equally often. Cues that err alike seem better than
    they are.

    Parameters
    ----------
    agreement : float
        The share of observations of which both say the same, 0 to 1.
    classes : int
        How many classes there are.

    References
    ----------
    Platanios, Blum and Mitchell, Estimating accuracy from unlabeled data, UAI 2014.
    """
    others = classes - 1
    inside = 1 / others**2 - classes / others * (1 / others - agreement)
    found = (1 / others + sqrt(max(inside, 0.0))) * others / classes
    return min(max(found, 1 / classes + MARGIN), 1 - MARGIN)


def log_odds_lost(known: float, here: float, classes: int) -> float:
    """Return by how much log odds shrink where cues agree less than where they were trained.

    Parameters
    ----------
    known, here : float
        How often they agree on held-out training samples, and here.
    classes : int
        How many classes there are.

    Returns
    -------
    float
        At least 1: the log odds of an observation's class against each other by accuracy as known,
        over those by accuracy here.
    """
    there, now = (accuracy_of(each, classes) for each in (known, here))
    return max(log(there * (classes - 1) / (1 - there)) / log(now * (classes - 1) / (1 - now)), 1.0)
