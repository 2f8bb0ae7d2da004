"""Which sets of cues there are schemes for, and which one is taken."""

from __future__ import annotations

import numpy as np
import pytest

from placecue import (
    HeldOut,
    Integrator,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    Probabilities,
    Schemes,
    Scores,
    StoredEvidence,
    sets_of,
)
from placecue.integrator import OnlyCue
from placecue_integrators.gdas import GDAS

FIVE = ("a", "b", "c", "d", "e")


def test_every_set_of_a_few_cues() -> None:
    assert sets_of(("a", "b")) == [("a", "b"), ("a",), ("b",)]
    assert len(sets_of(FIVE[:4])) == 15


def test_of_many_cues_those_that_happen() -> None:
    found = sets_of(FIVE, together=[("e", "d"), (), FIVE])
    assert len(found) == 1 + 5 + 5 + 1
    assert ("d", "e") in found  # in the order of all
    assert [len(each) for each in found] == sorted(map(len, found), reverse=True)


@pytest.mark.parametrize(
    ("there", "taken"),
    [(FIVE, FIVE), ("acd", ("c", "d")), ("ab", ("a",)), ("b", ()), ("", ())],
)
def test_the_largest_set_that_is_there(there: str, taken: tuple[str, ...]) -> None:
    schemes = Schemes({cues: OnlyCue() for cues in [FIVE, ("c", "d"), ("a",), ("c",)]})
    assert schemes.of(tuple(there)) == taken


def test_a_cue_alone_says_the_same_kind_as_the_sums() -> None:
    """Distances are added up, so one of them is a distance too, or maps average odd things."""
    classes = ("hall", "lab", "office")
    truth = np.arange(60) % 3
    generator = np.random.default_rng(0)
    layout = ModifiedOneAgainstAll(classes)
    of_cue = [
        Scores(-2 * (truth[:, None] != np.arange(3)) + 0.2 * generator.normal(size=(60, 3)), layout)
        for _ in range(2)
    ]
    evidence = StoredEvidence({"crfh": of_cue[0], "laser": of_cue[1]})
    schemes = Schemes.fit(GDAS(), HeldOut(evidence, np.array(classes)[truth]))
    alone, _ = schemes.integrate(evidence.only(["laser"]))
    np.testing.assert_array_equal(alone.values, np.abs(of_cue[1].values))


def test_where_no_cue_will_be_missing_there_is_one_scheme() -> None:
    layout, truth = OneAgainstAll(("hall", "lab")), np.arange(20) % 2
    scores = Scores(np.eye(2)[truth], layout)
    evidence = StoredEvidence(dict.fromkeys(("crfh", "laser", "sift"), scores))
    held_out = HeldOut(evidence, np.array(["hall", "lab"])[truth], whole=True)
    assert list(Schemes.fit(GDAS(), held_out).by_cues) == [("crfh", "laser", "sift")]


def test_where_an_integrator_fails_throughout_the_others_go_on() -> None:
    class Own(Integrator):
        def fit(self, evidence, labels, stamps=None):  # type: ignore[no-untyped-def]
            return self

        def integrate(self, evidence):  # type: ignore[no-untyped-def]
            if np.nanmax(evidence.scores("a").values) > 5:
                raise ValueError("too sure")
            return Scores(np.full((len(evidence), 2), 0.5), Probabilities(("hall", "lab")))

    layout = OneAgainstAll(("hall", "lab"))
    values = np.array([[9.0, 0], [1, 0], [0, 1], [9, 0]])
    other = np.array([[1.0, 0], [np.nan, np.nan], [np.nan, np.nan], [0, 1]])
    evidence = StoredEvidence({"a": Scores(values, layout), "b": Scores(other, layout)})
    schemes = Schemes({("a", "b"): Own(), ("a",): Own()})
    scores, failed = schemes.integrate(evidence, skip=True)
    assert scores.layout == Probabilities(("hall", "lab"))
    assert scores.available().tolist() == [False, True, True, False]
    assert sorted(failed) == [0, 3]
