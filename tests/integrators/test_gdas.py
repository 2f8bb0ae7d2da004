"""G-DAS by hand and against a brute-force grid; four classes or more, so that layouts differ."""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.metrics import balanced_accuracy_score

from placecue import (
    DataError,
    DecisionList,
    Layout,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Pipeline,
    Probabilities,
    Scores,
    StoredEvidence,
    UsageError,
)
from placecue_classifiers.svm import SVM
from placecue_integrators.gdas import GDAS
from placecue_kernels.rbf import RBF
from toys import Beams, Brightness

FOUR = ("corridor", "kitchen", "lab", "office")
HALVES = {"vision": 1, "laser": 1}


@dataclass(frozen=True)
class SmallestWins(OneAgainstAll):
    """A layout that is not built in, and decides otherwise than the one that it stems from."""

    name: ClassVar[str] = "smallest_wins"

    def preference(self, values: np.ndarray) -> np.ndarray:
        return -values


def evidence(layout: Layout, **values: object) -> StoredEvidence:
    return StoredEvidence({cue: Scores(np.array(v, float), layout) for cue, v in values.items()})


def integrated(gdas: GDAS, given: StoredEvidence) -> Scores:
    return gdas.fit(given, np.array(FOUR[:1] * len(given))).integrate(given)


def names(m: int) -> tuple[str, ...]:
    return tuple("abcdefg"[:m])


def layouts(m: int) -> list[Layout]:
    order = tuple(np.random.default_rng(m).permutation(names(m)))
    plain = [OneAgainstAll, OneAgainstOne, ModifiedOneAgainstAll, Probabilities, SmallestWins]
    return [*(kind(names(m)) for kind in plain), DecisionList(names(m), order)]


# ---------------------------------------------------------------------- worked by hand


def test_one_against_all() -> None:
    given = evidence(OneAgainstAll(FOUR), vision=[[1, 0, -1, -2]], laser=[[-1, 2, 0, 0]])
    scores = integrated(GDAS(weights={"vision": 1, "laser": 3}), given)
    assert scores.values.tolist() == [[-0.5, 1.5, -0.25, -0.5]]
    decision = scores.decide()
    assert (decision.labels[0], decision.confidence[0]) == ("kitchen", 1.75)


def test_one_against_one() -> None:
    # Columns: corridor against kitchen, lab, office; kitchen against lab, office; lab, office.
    given = evidence(
        OneAgainstOne(FOUR), vision=[[2, -1, 1, 1, 1, -3]], laser=[[-4, -1, 3, 3, -3, 1]]
    )
    scores = integrated(GDAS(weights=HALVES), given)
    assert scores.values.tolist() == [[-1, -1, 2, 2, -1, -1]]
    # Kitchen and office have two votes, office has beaten kitchen, and has lost to corridor by 2.
    decision = scores.decide()
    assert (decision.labels[0], decision.confidence[0]) == ("office", -2)


def test_a_decision_list() -> None:
    layout = DecisionList(FOUR, ("lab", "corridor", "office", "kitchen"))
    given = evidence(layout, vision=[[1, 0, -1, -1]], laser=[[1, 0, -0.5, 3]])
    decision = integrated(GDAS(weights=HALVES), given).decide()
    # Of (1, 0, -0.75, 1) lab is not positive, by 0.75, and corridor is, by 1.
    assert (decision.labels[0], decision.confidence[0]) == ("corridor", 0.75)


def test_probabilities() -> None:
    given = evidence(Probabilities(FOUR), vision=[[0.5, 0.5, 0, 0]], laser=[[0.25, 0, 0.75, 0]])
    scores = integrated(GDAS(weights="equal"), given)
    assert scores.values.tolist() == [[0.375, 0.25, 0.375, 0]]
    assert scores.decide().labels[0] == "corridor"


@pytest.mark.parametrize(
    ("option", "label", "confidence"),
    [
        # Distances (2, 2), (0.5, 0.7), (3, 3), (4, 4): half of their sums 2, 0.6, 3, 4.
        ("sum_of_distances", "kitchen", 1.4),
        # Half of the sums 0, 0.6, 3, 4.
        ("distance_of_sums", "corridor", 0.6),
    ],
)
def test_modified_one_against_all(option: str, label: str, confidence: float) -> None:
    layout = ModifiedOneAgainstAll(FOUR)
    given = evidence(layout, vision=[[2, 0.5, 3, 4]], laser=[[-2, 0.7, 3, 4]])
    decision = integrated(GDAS(weights=HALVES, modified_oaa=option), given).decide()
    assert (decision.labels[0], decision.confidence[0]) == (label, pytest.approx(confidence))


# ---------------------------------------------------------------------- the search


def brute_force(
    given: StoredEvidence, labels: np.ndarray, steps: int, distances: bool
) -> tuple[tuple[int, ...], float]:
    """Return the weights, in steps, that a plain grid of scikit-learn's scores comes to."""
    best: list[tuple[float, int, tuple[int, ...]]] = []
    for shares in itertools.product(range(steps + 1), repeat=len(given.cues)):
        if sum(shares) != steps:
            continue
        total = 0
        for share, cue in zip(shares, given.cues, strict=True):
            values = given.scores(cue).values
            total = total + share / steps * (np.abs(values) if distances else values)
        predicted = given.layout(given.cues[0]).decide(total).labels
        score = round(balanced_accuracy_score(labels, predicted), 10)
        best.append((-score, sum(share**2 for share in shares), tuple(-each for each in shares)))
    score, _, turned = min(best)
    return tuple(-each for each in turned), -score


@pytest.mark.parametrize("layout", [*layouts(4), *layouts(5)], ids=lambda x: f"{x.name}")
@pytest.mark.parametrize(("cues", "tied"), [(1, True), (2, True), (3, False), (4, True)])
def test_the_search_finds_what_a_plain_grid_finds(layout: Layout, cues: int, tied: bool) -> None:
    generator = np.random.default_rng((cues, len(layout.columns)))
    labels = np.array(layout.classes)[generator.integers(0, len(layout.classes), 60)]
    own = np.array([[label in column.split("|") for column in layout.columns] for label in labels])
    # Whole numbers and quarters are summed without rounding, and have ties of every kind.
    shape = cues, *own.shape
    values = generator.integers(-2, 3, shape) if tied else generator.normal(size=shape)
    given = evidence(layout, **{f"cue {t}": values[t] + own for t in range(cues)})
    for option in ("sum_of_distances", "distance_of_sums"):
        gdas = GDAS(step=0.25, modified_oaa=option).fit(given, labels)
        distances = option == "sum_of_distances" and isinstance(layout, ModifiedOneAgainstAll)
        shares, accuracy = brute_force(given, labels, 4, distances)
        assert tuple(gdas.weights_ * 4) == shares
        assert gdas.balanced_accuracy_ == pytest.approx(accuracy)


def test_the_search_rounds_as_integration_does() -> None:
    generator = np.random.default_rng(3)
    for layout in layouts(4):
        codes = generator.integers(0, 4, 200)
        width = len(layout.columns)
        given = evidence(layout, **{cue: generator.normal(size=(200, width)) for cue in "xyz"})
        labels = np.array(layout.classes)[codes]
        gdas = GDAS(step=0.1).fit(given, labels)
        found = balanced_accuracy_score(labels, gdas.integrate(given).decide().labels)
        assert gdas.balanced_accuracy_ == pytest.approx(found)
        assert (gdas.weights_ >= 0).all()
        assert gdas.weights_.sum() == pytest.approx(1)


def test_of_equally_good_weights_the_most_even_are_taken() -> None:
    generator = np.random.default_rng(4)
    same = generator.normal(size=(40, 4))
    labels = np.array(FOUR)[generator.integers(0, 4, 40)]
    two = evidence(OneAgainstAll(FOUR), a=same, b=same)
    assert GDAS(step=0.5).fit(two, labels).weights_.tolist() == [0.5, 0.5]
    # Of (1/2, 1/4, 1/4) and its turns, that with more weight on what comes first.
    three = evidence(OneAgainstAll(FOUR), a=same, b=same, c=same)
    assert GDAS(step=0.25).fit(three, labels).weights_.tolist() == [0.5, 0.25, 0.25]


def test_a_cue_that_knows_nothing_has_little_weight() -> None:
    generator = np.random.default_rng(5)
    codes = generator.integers(0, 4, 400)
    knows = generator.normal(size=(400, 4)) + 3 * np.eye(4)[codes]
    noise = 5 * generator.normal(size=(400, 4))
    given = evidence(OneAgainstAll(FOUR), knows=knows, noise=noise)
    weights = GDAS().fit(given, np.array(FOUR)[codes]).weights_
    assert weights[0] >= 0.85


def test_samples_that_lack_a_cue_are_left_out_and_stay_untold() -> None:
    generator = np.random.default_rng(6)
    labels = np.array(FOUR)[generator.integers(0, 4, 60)]
    a, b = generator.normal(size=(2, 60, 6))
    a[::3], b[::4] = np.nan, np.nan
    given = evidence(OneAgainstOne(FOUR), a=a, b=b)
    there = ~np.isnan(a + b).any(axis=1)
    some = GDAS().fit(given.take(there), labels[there])
    gdas = GDAS().fit(given, labels)
    assert gdas.weights_.tolist() == some.weights_.tolist()
    assert (gdas.integrate(given).available() == there).all()


# ---------------------------------------------------------------------- given weights, few cues


def test_given_weights_are_divided_by_their_sum() -> None:
    given = evidence(OneAgainstAll(FOUR), a=np.eye(4), b=np.eye(4), c=np.eye(4))
    gdas = GDAS(weights={"c": 1, "a": 3, "b": 0}).fit(given, np.array(FOUR))
    assert gdas.weights_.tolist() == [0.75, 0, 0.25]
    assert gdas.balanced_accuracy_ is None
    assert GDAS(weights="equal").fit(given, np.array(FOUR)).weights_ == pytest.approx([1 / 3] * 3)


def test_where_fewer_cues_are_there_their_weights_share_the_whole() -> None:
    given = evidence(OneAgainstAll(FOUR), a=np.eye(4), b=np.eye(4))
    weights = {"a": 1, "b": 3, "c": 4}
    assert GDAS(weights=weights).fit(given, np.array(FOUR)).weights_.tolist() == [0.25, 0.75]
    only_c = {"a": 0, "b": 0, "c": 1}
    assert GDAS(weights=only_c).fit(given, np.array(FOUR)).weights_.tolist() == [0.5, 0.5]


@pytest.mark.parametrize("weights", ["search", "equal", {"a": 7}])
@pytest.mark.parametrize("layout", layouts(4), ids=lambda x: x.name)
def test_one_cue_is_passed_on(layout: Layout, weights: object) -> None:
    values = np.random.default_rng(7).normal(size=(30, len(layout.columns)))
    given = evidence(layout, a=values)
    labels = np.array(layout.classes * 8)[:30]
    gdas = GDAS(weights=weights).fit(given, labels)  # type: ignore[arg-type]
    assert gdas.weights_.tolist() == [1]
    found, alone = gdas.integrate(given).decide(), given.scores("a").decide()
    assert (found.labels == alone.labels).all()
    assert (found.confidence == alone.confidence).all()


def test_one_sample_and_one_class_are_enough() -> None:
    given = evidence(OneAgainstAll(FOUR), a=[[1, 2, 0, 0]], b=[[2, 1, 0, 0]])
    gdas = GDAS(step=0.25).fit(given, np.array(["kitchen"]))
    # 3/4 to a decides for the kitchen; a half each is a tie, which goes to the corridor.
    assert gdas.weights_.tolist() == [0.75, 0.25]
    assert gdas.balanced_accuracy_ == 1
    assert len(gdas.integrate(given.take(np.arange(0)))) == 0


def test_cues_are_known_by_name() -> None:
    generator = np.random.default_rng(8)
    a, b = generator.normal(size=(2, 20, 4))
    labels = np.array(FOUR * 5)
    layout = OneAgainstAll(FOUR)
    gdas = GDAS(weights={"a": 1, "b": 3}).fit(evidence(layout, a=a, b=b), labels)
    turned = gdas.integrate(evidence(layout, other=a, b=b, a=a))
    assert turned.values == pytest.approx(0.25 * a + 0.75 * b)


def test_scikit_learn_contract() -> None:
    gdas = GDAS(weights={"a": 1}, step=0.1)
    assert clone(gdas).get_params() == gdas.get_params()


# ---------------------------------------------------------------------- bad input


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (
            OneAgainstOne(FOUR),
            "those of 'vision' are one_against_all of corridor, kitchen, lab, office, those of "
            "'laser' one_against_one of corridor, kitchen, lab, office; ",
        ),
        # A class that the laser never saw.
        (OneAgainstAll(FOUR[:3]), "those of 'laser' one_against_all of corridor, kitchen, lab; "),
    ],
)
def test_unequal_layouts_are_refused(other: Layout, said: str) -> None:
    values = {"vision": OneAgainstAll(FOUR), "laser": other}
    given = StoredEvidence(
        {cue: Scores(np.zeros((4, len(layout.columns))), layout) for cue, layout in values.items()}
    )
    with pytest.raises(UsageError, match=re.escape(said)) as refused:
        GDAS().fit(given, np.array(FOUR))
    assert "choose integrator=svm_das" in str(refused.value)


def test_decision_lists_in_another_order_are_refused() -> None:
    lists = DecisionList(FOUR, FOUR), DecisionList(FOUR, FOUR[::-1])
    cues = zip(("a", "b"), lists, strict=True)
    given = StoredEvidence({cue: Scores(np.zeros((4, 4)), layout) for cue, layout in cues})
    said = "decision_list in the order office, lab, kitchen, corridor"
    with pytest.raises(UsageError, match=said):
        GDAS(weights="equal").fit(given, np.array(FOUR))


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"weights": "even"}, "weights is 'even'; available: equal, search"),
        ({"weights": {"a": -1, "b": 1}}, "weights.a is -1; give a number of at least 0"),
        ({"weights": {"a": np.inf, "b": 1}}, "weights.a is inf; give a finite number"),
        ({"weights": {"a": np.nan, "b": 1}}, "weights.a is nan; give a number of at least 0"),
        ({"weights": {"a": 0, "b": 0}}, r"weights are all 0 \(a, b\)"),
        ({"weights": {}}, "weights are all 0"),
        ({"weights": {"a": 1, "c": 1}}, "no weight for cue 'b', only for a, c"),
        ({"step": 0}, "step is 0; give a number above 0"),
        ({"step": 1.5}, "step is 1.5; give a number of at most 1"),
        ({"step": 0.3}, "step is 0.3, which does not part 1 evenly; give one such as 0.25"),
        ({"step": 1e-6}, "1000001 weightings of 2 cues"),
        ({"modified_oaa": "sums"}, "modified_oaa is 'sums'"),
    ],
)
def test_parameters_that_cannot_be_are_refused(parameters: dict[str, object], said: str) -> None:
    given = evidence(OneAgainstAll(FOUR), a=np.eye(4), b=np.eye(4))
    with pytest.raises(UsageError, match=said):
        GDAS(**parameters).fit(given, np.array(FOUR))  # type: ignore[arg-type]


def test_a_pipeline_refuses_a_weight_of_a_cue_that_is_not_there() -> None:
    cues = {
        "beams": (Beams(), SVM(kernel=RBF())),
        "brightness": (Brightness(), SVM(kernel=RBF())),
    }
    with pytest.raises(UsageError, match=r"cue 'beam', which is not there; did you mean 'beams'\?"):
        Pipeline(cues, GDAS(weights={"beam": 1, "brightness": 1, "beams": 1}))
    with pytest.raises(UsageError, match="no weight for cue 'brightness', only for beams"):
        Pipeline(cues, GDAS(weights={"beams": 1}))


def test_samples_that_cannot_be_fitted_on_are_refused() -> None:
    layout, labels = OneAgainstAll(FOUR), np.array(FOUR)
    gap = np.full((4, 4), np.nan)
    with pytest.raises(DataError, match=r"no sample has scores of all cues \(a, b\)"):
        GDAS().fit(evidence(layout, a=gap, b=np.eye(4)), labels)
    given = evidence(layout, a=np.eye(4), b=np.eye(4))
    with pytest.raises(DataError, match="labelled 'garage', which is no class of the scores"):
        GDAS().fit(given, np.array(["corridor", "garage", "lab", "office"]))
    with pytest.raises(DataError, match=r"evidence of 4 samples and labels of shape \(3,\)"):
        GDAS().fit(given, labels[:3])
    # Weights that are not searched ask for no sample.
    assert GDAS(weights="equal").fit(evidence(layout, a=gap, b=gap), labels).weights_[0] == 0.5


def test_scores_of_other_models_are_refused() -> None:
    labels = np.array(FOUR)
    gdas = GDAS().fit(evidence(OneAgainstAll(FOUR), a=np.eye(4), b=np.eye(4)), labels)
    with pytest.raises(UsageError, match=r"the scores of cue 'a' are Probabilities\("):
        gdas.integrate(evidence(Probabilities(FOUR), a=np.eye(4), b=np.eye(4)))
    with pytest.raises(UsageError, match="there is no evidence of cue 'b'; available: a"):
        gdas.integrate(evidence(OneAgainstAll(FOUR), a=np.eye(4)))
