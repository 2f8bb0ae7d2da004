"""Votes, counted by hand, by a loop over fractions, and by scikit-learn; four classes."""

from fractions import Fraction

import numpy as np
import pytest
from sklearn.ensemble import VotingClassifier

from peers import Columns, side_by_side
from placecue import (
    DecisionList,
    Layout,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
    Scores,
    StoredEvidence,
    UsageError,
)
from placecue_integrators.vote import Vote
from placecue_integrators.votes import Votes

CLASSES = ("corridor", "kitchen", "lab", "office")
LAYOUTS: dict[str, Layout] = {
    "a": OneAgainstAll(CLASSES),
    "b": OneAgainstOne(CLASSES),
    "c": ModifiedOneAgainstAll(CLASSES),
    "d": Probabilities(CLASSES),
    "e": DecisionList(CLASSES, ("lab", "office", "corridor", "kitchen")),
}


def ranked(*orders: str) -> StoredEvidence:
    """One sample by cues that rank the classes, by their initials, from first to last."""
    initials = "".join(name[0] for name in CLASSES)
    rows = {str(i): [[-order.index(x) for x in initials]] for i, order in enumerate(orders)}
    layout = OneAgainstAll(CLASSES)
    return StoredEvidence({cue: Scores(np.array(r, float), layout) for cue, r in rows.items()})


def random_evidence(n: int = 200, gaps: bool = True) -> StoredEvidence:
    generator = np.random.default_rng(3)
    scores = {}
    for cue, layout in LAYOUTS.items():
        values = generator.normal(size=(n, len(layout.columns)))
        if gaps:
            values[generator.random(n) < 0.4] = np.nan
        scores[cue] = Scores(values, layout)
    return StoredEvidence(scores)


def voted(evidence: StoredEvidence, **parameters: object) -> Scores:
    labels = np.resize(CLASSES, len(evidence))
    return Vote(**parameters).fit(evidence, labels).integrate(evidence)  # type: ignore[arg-type]


def test_the_most_votes_win() -> None:
    scores = voted(ranked("kclo", "lkco", "kolc"))
    assert scores.values[0] == pytest.approx([0, 2 / 3, 1 / 3, 0, 3 / 9, 8 / 9, 5 / 9, 2 / 9])
    decision = scores.decide()
    assert decision.labels.tolist() == ["kitchen"]
    assert decision.confidence == pytest.approx([1 / 3])
    assert decision.ranking.tolist() == [[1, 2, 0, 3]]


def test_among_the_tied_the_rank_points_decide() -> None:
    # Rank points 3, 2, 1, 0: corridor 3 + 1 + 1, kitchen 2 + 3 + 2, lab 1 + 2 + 3.
    decision = voted(ranked("cklo", "klco", "lkco")).decide()
    assert decision.labels.tolist() == ["kitchen"]
    assert decision.ranking.tolist() == [[1, 2, 0, 3]]
    assert decision.confidence.tolist() == [0]


def test_rank_points_count_for_nothing_where_votes_differ() -> None:
    # Kitchen is second to all of them and has most points; corridor has two of the three votes.
    decision = voted(ranked("cklo", "ckol", "lkoc")).decide()
    assert decision.labels.tolist() == ["corridor"]


def test_where_points_are_level_too_the_first_label_wins() -> None:
    decision = voted(ranked("olkc", "lokc")).decide()
    assert decision.labels.tolist() == ["lab"]
    assert decision.confidence.tolist() == [0]


def test_weights_that_add_up_to_the_same_are_level() -> None:
    # 0.1 + 0.2 is a little more than 0.3 in floating point; the points of kitchen decide:
    # 0.1 + 0.2 + 0.3 * 2/3 against 0.3 + (0.1 + 0.2) / 3.
    weights = {"0": 0.1, "1": 0.2, "2": 0.3}
    assert voted(ranked("kcol", "kcol", "cokl"), weights=weights).decide().labels == ["corridor"]
    assert voted(ranked("kolc", "kolc", "cklo"), weights=weights).decide().labels == ["kitchen"]


def test_one_cue_is_as_it_decides_itself() -> None:
    evidence = random_evidence(gaps=False)
    for cue in LAYOUTS:
        alone = StoredEvidence({cue: evidence.scores(cue)})
        assert np.array_equal(
            voted(alone).decide().ranking[:, 0], evidence.scores(cue).decide().ranking[:, 0]
        )


@pytest.mark.parametrize("weights", [None, {"a": 2, "c": 0.5}, {"b": 0, "d": 3}])
def test_it_equals_a_count_by_fractions(weights: dict[str, float] | None) -> None:
    evidence = random_evidence()
    decision_rows = np.flatnonzero(voted(evidence, weights=weights).available())
    found = voted(evidence, weights=weights)[decision_rows].decide()
    expected = []
    for row in range(len(evidence)):
        votes = dict.fromkeys(range(4), Fraction(0))
        points = dict.fromkeys(range(4), Fraction(0))
        counted = 0
        for cue in LAYOUTS:
            weight = Fraction((weights or {}).get(cue, 1))
            one = evidence.scores(cue)[[row]]
            if weight == 0 or np.isnan(one.values).any():
                continue
            counted += 1
            ranking = one.decide().ranking[0].tolist()
            votes[ranking[0]] += weight
            for place, code in enumerate(ranking):
                points[code] += weight * (3 - place)
        if counted:
            expected.append(min(range(4), key=lambda k: (-votes[k], -points[k], k)))
    assert len(expected) == len(decision_rows) < len(evidence)
    assert found.ranking[:, 0].tolist() == expected


@pytest.mark.parametrize("weights", [None, (1.0, 1.5, 0.75)])
def test_it_equals_scikit_learn_s_hard_voting(weights: tuple[float, ...] | None) -> None:
    evidence = random_evidence(gaps=False)
    some = StoredEvidence({cue: evidence.scores(cue) for cue in "acd"})
    # Whole columns a class, whose largest wins, as scikit-learn has them.
    joined = side_by_side({cue: s.layout.preference(s.values) for cue, s in _of(some).items()})
    labels = np.resize(CLASSES, len(evidence))
    peers = [(cue, Columns(4 * i, 4 * i + 4)) for i, cue in enumerate("acd")]
    peer = VotingClassifier(peers, voting="hard", weights=weights).fit(joined, labels)
    by_name = None if weights is None else dict(zip("acd", weights, strict=True))
    decision = voted(some, weights=by_name).decide()
    clear = decision.confidence > 1e-6  # it breaks ties by label alone
    assert clear.sum() > 50
    assert np.array_equal(decision.labels[clear], peer.predict(joined)[clear])


def _of(evidence: StoredEvidence) -> dict[str, Scores]:
    return {cue: evidence.scores(cue) for cue in evidence.cues}


class Watched(StoredEvidence):
    """Notes which cues are asked for."""

    def __init__(self, scores: dict[str, Scores]) -> None:
        super().__init__(scores)
        self.asked: set[str] = set()

    def scores(self, cue: str) -> Scores:
        self.asked.add(cue)
        return super().scores(cue)

    def layout(self, cue: str) -> Layout:
        return LAYOUTS[cue]


def test_a_cue_that_counts_nothing_is_not_asked() -> None:
    evidence = Watched(_of(random_evidence()))
    vote = Vote(weights={"b": 0}).fit(evidence, np.resize(CLASSES, len(evidence)))
    vote.integrate(evidence)
    assert evidence.asked == {"a", "c", "d", "e"}


@pytest.mark.parametrize(
    ("weights", "said"),
    [
        ({"lasr": 1}, "weights of votes name cue 'lasr'; did you mean 'laser'. available: l"),
        ({"laser": -1}, "weights.laser is -1; give a number of at least 0"),
        ({"laser": float("inf")}, "weights.laser is inf; give a number below inf"),
        ({"laser": 0}, r"the votes of all cues \(laser\) count 0: give one of them a weight"),
    ],
)
def test_wrong_weights_are_refused(weights: dict[str, float], said: str) -> None:
    evidence = StoredEvidence({"laser": Scores(np.eye(4), OneAgainstAll(CLASSES))})
    with pytest.raises(UsageError, match=said):
        Vote(weights=weights).fit(evidence, CLASSES)


def test_the_mean_of_two_samples_votes_is_a_vote_of_both() -> None:
    # As an accumulator adds them up over a place.
    both = voted(ranked("kclo", "lkco", "kolc")), voted(ranked("lkco", "lkco", "lcko"))
    mean = np.mean([each.values for each in both], axis=0)
    assert Votes(CLASSES).decide(mean).labels == ["lab"]
    assert Votes(CLASSES).columns[0] == "corridor:votes"
    assert Votes(CLASSES).columns[7] == "office:points"
