"""The compiled rules are those of the layouts, to the last bit, ties included."""

from __future__ import annotations

import numpy as np
import pytest

from placecue import (
    DecisionList,
    Layout,
    ModifiedOneAgainstAll,
    OneAgainstAll,
    OneAgainstOne,
    Probabilities,
)
from placecue_integrators.winners import recognised, rule_of

NAMES = tuple("abcdefg")


def layouts(m: int) -> list[Layout]:
    classes, order = NAMES[:m], tuple(np.random.default_rng(m).permutation(NAMES[:m]))
    kinds = OneAgainstAll, OneAgainstOne, ModifiedOneAgainstAll, Probabilities
    return [*(kind(classes) for kind in kinds), DecisionList(classes, order)]


@pytest.mark.parametrize("spread", [0, 1, 2, None])
@pytest.mark.parametrize("layout", [each for m in (2, 4, 5, 7) for each in layouts(m)])
def test_the_winner_is_the_layout_s(layout: Layout, spread: int | None) -> None:
    generator = np.random.default_rng(0)
    shape = 2, 500, len(layout.columns)
    if spread is None:
        outputs = generator.normal(size=shape)
    else:
        outputs = generator.integers(-spread, spread + 1, shape).astype(float)
        outputs[generator.random(shape) < 0.1] *= -0.0
    found = rule_of(layout)
    assert found is not None
    rule, table = found
    weights = np.array([[1.0, 0.3, 0.5], [0.0, 0.7, 0.5]])
    for g, (a, b) in enumerate(weights.T):
        winners = layout.decide(a * outputs[0] + b * outputs[1]).ranking[:, 0]
        by_sample = np.ascontiguousarray(outputs.transpose(1, 0, 2))
        m = len(layout.classes)
        right = recognised(by_sample, weights, winners, m, int(rule), table)
        assert (right[:, g] == np.bincount(winners, minlength=m)).all()
        for shift in range(1, m):  # and no other class does
            other = (winners + shift) % m
            assert not recognised(by_sample, weights, other, m, int(rule), table)[:, g].any()


def test_a_layout_that_stems_from_a_built_in_one_is_asked_itself() -> None:
    class Other(OneAgainstAll):
        pass

    assert rule_of(Other(NAMES)) is None
