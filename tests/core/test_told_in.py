"""What one layout says, told in another: the same labels, rankings and, where it can be, leads."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from placecue import (
    DecisionList,
    Layout,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
    Scores,
)

CLASSES = ("corridor", "kitchen", "lab", "office")
LAYOUTS = {
    "oaa": OneAgainstAll(CLASSES),
    "modified": ModifiedOneAgainstAll(CLASSES),
    "oao": OneAgainstOne(CLASSES),
    "probabilities": Probabilities(CLASSES),
    "list": DecisionList(CLASSES, order=("lab", "corridor", "office", "kitchen")),
}
PAIRS = [*product(LAYOUTS, LAYOUTS)]


def scores(layout: Layout, n: int = 200) -> Scores:
    values = np.random.default_rng(3).normal(size=(n, len(layout.columns)))
    if isinstance(layout, Probabilities):
        values = np.abs(values) / np.abs(values).sum(axis=1, keepdims=True)
    return Scores(values, layout)


@pytest.mark.parametrize(("of", "told"), PAIRS)
def test_labels_stay(of: str, told: str) -> None:
    made = scores(LAYOUTS[of])
    found = made.told_in(LAYOUTS[told])
    assert found is not None
    assert found.layout == LAYOUTS[told]
    assert found.decide().labels.tolist() == made.decide().labels.tolist()
    if told != "list":  # which ranks by its own order
        assert found.decide().ranking.tolist() == made.decide().ranking.tolist()


@pytest.mark.parametrize("told", ["oaa", "modified", "oao"])
@pytest.mark.parametrize("of", ["oaa", "modified", "probabilities"])
def test_leads_stay(of: str, told: str) -> None:
    made = scores(LAYOUTS[of])
    found = made.told_in(LAYOUTS[told])
    assert found is not None
    np.testing.assert_allclose(found.decide().confidence, made.decide().confidence, atol=1e-12)


def test_a_worked_example() -> None:
    made = Scores(np.array([[0.5, -1.0, 2.0, 0.0]]), OneAgainstAll(CLASSES))
    pairs = made.told_in(LAYOUTS["oao"])
    assert pairs is not None
    # corridor|kitchen, corridor|lab, corridor|office, kitchen|lab, kitchen|office, lab|office
    assert pairs.values.tolist() == [[1.5, -1.5, 0.5, -3.0, -1.0, 2.0]]
    centred = made.told_in(LAYOUTS["modified"])
    assert centred is not None
    assert centred.values.tolist() == [[1.5, 3.0, 0.0, 2.0]]


def test_gaps_stay_and_other_classes_cannot_be_told() -> None:
    made = scores(LAYOUTS["oao"], 3)
    made.values[1] = np.nan
    found = made.told_in(LAYOUTS["oaa"])
    assert found is not None
    assert found.available().tolist() == [True, False, True]
    assert made.told_in(OneAgainstAll(("attic", "hall"))) is None


def test_a_layout_of_others_need_not_tell() -> None:
    class Own(OneAgainstAll):
        name = "own"
        of_preference = Layout.of_preference

    assert scores(LAYOUTS["oaa"]).told_in(Own(CLASSES)) is None
