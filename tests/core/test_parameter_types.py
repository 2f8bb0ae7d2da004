"""Config values against what parameters are annotated with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import pytest

from placecue.components.parameter_types import fits, in_words, misfits
from placecue.kernel import Kernel
from placecue_kernels.rbf import RBF

if TYPE_CHECKING:
    from nowhere import Unknown


@pytest.mark.parametrize(
    ("value", "hint", "expected"),
    [
        (1, float, True),
        (1.5, float, True),
        (True, float, False),
        ("1", float, False),
        (None, float, False),
        (None, float | None, True),
        (2, int, True),
        (2.0, int, False),
        (False, int, False),
        (False, bool, True),
        (0, bool, False),
        (3, str, False),
        ([1, 2.5], Sequence[float], True),
        ((1, 2), Sequence[float], True),
        ([1, "a"], Sequence[float], False),
        ("abc", Sequence[str], False),
        (["a"], str | Sequence[str], True),
        ({"C": [1, 10]}, Mapping[str, Sequence[float]], True),
        ({"C": 1}, Mapping[str, Sequence[float]], False),
        ({77: "room"}, Mapping[int, str], True),
        ([1, "a"], tuple[int, str], True),  # cannot be told
        (RBF(), Kernel, True),
        ("rbf", Kernel | None, False),
        ([RBF(), RBF()], Sequence[Kernel], True),
        (object(), Any, True),
        ("x", bytes, True),  # cannot be told
    ],
)
def test_fits(value: object, hint: object, expected: bool) -> None:
    assert fits(value, hint) is expected


@pytest.mark.parametrize(
    ("hint", "said"),
    [
        (float, "a number"),
        (int | None, "a whole number or null"),
        (Sequence[str] | None, "a list of texts or null"),
        (Mapping[str, Sequence[float]], "a mapping of lists of numbers"),
        (Kernel, "a kernel such as {plugin: NAME}"),
        (Sequence[Kernel], "a list of kernels"),
    ],
)
def test_in_words(hint: object, said: str) -> None:
    assert in_words(hint) == said


def test_every_misfit_is_named() -> None:
    class Known:
        def __init__(self, C: float = 1.0, name: str = "", rest: Any = None, free=None) -> None: ...  # type: ignore[no-untyped-def]

    assert misfits({"C": "x", "name": 3, "rest": 3, "free": 3, "other": 3}, Known) == [
        "C must be a number, got 'x'",
        "name must be text, got 3",
    ]


def test_annotations_for_checkers_only_are_not_judged() -> None:
    class Elsewhere:
        def __init__(self, C: float, of: Unknown) -> None: ...

    assert misfits({"C": "x"}, Elsewhere) == []
