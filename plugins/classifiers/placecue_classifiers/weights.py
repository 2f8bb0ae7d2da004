"""Weights of classes given by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError, choices

#: "balanced", None, or weights by class.
ClassWeight: TypeAlias = str | Mapping[str, float] | None


def check_class_weight(class_weight: Any) -> None:
    """Raise UsageError unless it is "balanced", None, or a mapping of classes to weights."""
    if isinstance(class_weight, Mapping):
        for name, weight in class_weight.items():
            if isinstance(weight, (bool, str)) or not weight > 0:
                raise UsageError(f"class_weight.{name} must be a number above 0, got {weight!r}")
    elif class_weight not in ("balanced", None):
        raise UsageError(
            f"class_weight is 'balanced', null, or weights by class such as {{office: 2}}; "
            f"got {class_weight!r}"
        )


def of_classes(class_weight: ClassWeight, names: Sequence[str]) -> NDArray[np.float64] | None:
    """Return the weight of each class, shape (M,), 1 where none is given; None unless by name.

    Raises
    ------
    UsageError
        If a name is none of the classes.
    """
    if not isinstance(class_weight, Mapping):
        return None
    given = {str(name): float(weight) for name, weight in class_weight.items()}
    for name in given:
        if name not in names:
            raise UsageError(f"class_weight names '{name}'; {choices(name, names)}")
    return np.array([given.get(name, 1.0) for name in names])
