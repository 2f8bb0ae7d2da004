"""What accumulated scores say: a label by the layout's own rule, and how probable each class is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from placecue.belief import Belief
from placecue.checks import check_number
from placecue.distribution import doubted, log_odds, softmax, tempered
from placecue.errors import UsageError
from placecue.scores import Layout, Probabilities
from placecue.semantic_map import UNKNOWN
from placecue_accumulators.histogram import BinSums
from placecue_accumulators.strangeness import ALONE, Strangeness

Values = NDArray[np.float64]

#: Log odds of one belief by the unit of its scores, where the model has learned none: what a
#: support vector machine's margins come to.
USUAL_SHARPNESS = 3.0


@dataclass(frozen=True, slots=True)
class Judgement:
    """What accumulated scores say of a place.

    Parameters
    ----------
    label : str
        The class, or ``unknown``.
    probability : float
        That it is the right one; 0 where unknown.
    margin : float
        Confidence by the layout's own rule, in the unit of the scores; 0 where unknown.
    probabilities : dict of str to float
        Of every class; empty where nothing was seen.
    scores : dict of str to float
        Mean over bins by column of the layout.
    """

    label: str = UNKNOWN
    probability: float = 0.0
    margin: float = 0.0
    probabilities: dict[str, float] = field(default_factory=dict)
    scores: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Judge:
    """Turns scores summed over bins into a judgement.

    Parameters
    ----------
    layout : Layout
        What the scores are.
    sharpness : float
        Log odds of one belief by the unit of its scores.
    least_margin : float
        Less than this confidence, in the unit of the scores, is unknown.
    least_probability : float
        So is less than this.
    independent : float
        The share of what a bin says that its neighbours have not said already, 0 to 1.
    doubt : float
        The share of places at which beliefs may say anything, 0 to 1.
    most_bins : float
        More bins make no surer than this many.
    temperature : float
        Log odds of a place are divided by this before they are told: beliefs in a building that
        was not trained on err alike.
    strangeness : Strangeness
        And by its factor.
    """

    layout: Layout
    sharpness: float
    least_margin: float
    least_probability: float
    independent: float
    doubt: float
    most_bins: float
    temperature: float
    strangeness: Strangeness

    def likelihoods(self, sums: BinSums) -> Values:
        """Return the log-likelihood of each class, up to a constant, shape (M,)."""
        if sums.bins <= 0:
            return np.zeros(len(self.layout.classes))
        bins = min(sums.bins, self.most_bins)
        worth = bins if bins <= 1 else 1 + self.independent * (bins - 1)
        return np.asarray(worth * np.log(self.single(sums.mean())))

    def single(self, values: Values) -> Values:
        """Return the probability of each class by one belief's scores, shape (M,)."""
        odds = self.sharpness * log_odds(values[None], self.layout)[0]
        return doubted(softmax(odds), self.doubt)

    def probabilities(self, sums: BinSums) -> Values:
        """Return the probability of each class, shape (M,)."""
        return self.told(softmax(self.likelihoods(sums)))

    def told(self, probabilities: Values) -> Values:
        """Return how probable the classes of places are told to be, shape (..., M)."""
        temperature = self.temperature * self.strangeness.factor
        return doubted(tempered(probabilities, temperature), self.doubt)

    def judge(self, sums: BinSums) -> Judgement:
        """Judge scores of a bin or more."""
        if sums.bins <= 0:
            return Judgement()
        mean = sums.mean()
        decision = self.layout.decide(mean[None])
        label, margin = str(decision.labels[0]), float(decision.confidence[0])
        probabilities = self.probabilities(sums)
        by_class = dict(zip(self.layout.classes, probabilities.tolist(), strict=True))
        scores = dict(zip(self.layout.columns, mean.tolist(), strict=True))
        if margin < self.least_margin or by_class[label] < self.least_probability:
            return Judgement(probabilities=by_class, scores=scores)
        return Judgement(label, by_class[label], margin, by_class, scores)


def accepts(belief: Belief, least_confidence: float) -> bool:
    """Tell whether a belief counts: it is sure enough, not called unknown, and made of numbers."""
    sure = belief.label != UNKNOWN and belief.confidence >= least_confidence
    return sure and bool(np.isfinite(belief.scores.values).all())


class Judging(Protocol):
    """An accumulator that judges what it has gathered."""

    label_probability: float
    sharpness: float | None
    independent: float
    doubt: float
    prior_bins: float
    temperature: float
    judge_: Judge | None


def judge_for(owner: Judging, belief: Belief, least_margin: float) -> Judge:
    """Return the judge of an accumulator's beliefs; the first of them tells what they are.

    Raises
    ------
    UsageError
        If this one's scores are of another layout than those before.
    """
    known, layout = owner.judge_, belief.scores.layout
    if known is not None:
        check_same_layout(known.layout, layout)
        return known
    learned = owner.sharpness is None and belief.sharpness is not None
    otherwise = ALONE if learned else 1.0  # a sharpness that is given is meant as it is
    return Judge(
        layout=layout,
        sharpness=owner.sharpness or belief.sharpness or usual_sharpness(layout),
        least_margin=least_margin,
        least_probability=owner.label_probability,
        independent=owner.independent,
        doubt=owner.doubt,
        most_bins=owner.prior_bins,
        temperature=owner.temperature,
        strangeness=Strangeness(belief.agreement, len(layout.classes), otherwise),
    )


def check_judging(owner: Judging) -> None:
    """Raise UsageError if a share is not between 0 and 1, or another number not above 0."""
    for name in ("label_probability", "doubt"):
        check_number(name, getattr(owner, name), least=0, below=1)
    check_number("independent", owner.independent, least=0, most=1)
    check_number("temperature", owner.temperature, above=0)
    if owner.sharpness is not None:
        check_number("sharpness", owner.sharpness, above=0)


def usual_sharpness(layout: Layout) -> float:
    """Return the sharpness of a model that has learned none: 1 for probabilities."""
    return 1.0 if isinstance(layout, Probabilities) else USUAL_SHARPNESS


def check_same_layout(known: Layout, layout: Layout) -> None:
    """Raise UsageError if the scores of one pipeline are no longer what they were."""
    if layout is not known and layout != known:
        raise UsageError(
            f"the layout of scores changed from {_described(known)} to {_described(layout)}: an "
            "accumulator takes the beliefs of one pipeline; reset it before it is given another's"
        )


def _described(layout: Layout) -> str:
    return f"{layout.name} of {len(layout.classes)} classes ({', '.join(layout.classes)})"
