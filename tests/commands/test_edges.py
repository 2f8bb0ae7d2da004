"""A parameter whose best value is the first or last of its grid is told."""

from __future__ import annotations

import pytest

from placecue.commands.show import _edge


@pytest.mark.parametrize(
    ("values", "scores", "edge"),
    [
        ([1, 10, 100], [0.1, 0.2, 0.3], "largest"),
        ([1, 10, 100], [0.3, 0.2, 0.1], "smallest"),
        ([1, 10, 100], [0.1, 0.3, 0.2], None),
        ([1, 10, 100], [0.1, 0.3, 0.3], None),  # one of the best lies within
        ([1, 100, 1, 100], [0.1, 0.2, 0.1, 0.3], "largest"),
        ([5, 5], [0.1, 0.2], None),  # not searched
        ([1, 10, 100], [0.1, 0.298, 0.3], None),  # as good beside the end
        (["oaa", "oao"], [0.1, 0.2], None),
        ([True, False], [0.1, 0.2], None),
    ],
)
def test_edge(values: list[object], scores: list[float], edge: str | None) -> None:
    assert _edge(values, scores) == edge
