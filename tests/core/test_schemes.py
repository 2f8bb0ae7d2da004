"""Which sets of cues there are schemes for, and which one is taken."""

from __future__ import annotations

import pytest

from placecue import Schemes, sets_of
from placecue.integrator import OnlyCue

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
