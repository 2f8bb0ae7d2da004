"""What several checks ask, and how they say it."""

from __future__ import annotations

from math import isfinite
from numbers import Integral, Real
from typing import Any

import numpy as np

from placecue.errors import described


def rows(made: Any, n: int) -> str | None:
    """Check that there are as many rows as samples."""
    given = made.shape[0]
    return None if given == n else f"returned {counted(given, 'row')} for {counted(n, 'sample')}"


def numbers(values: np.ndarray[Any, Any]) -> str | None:
    """Check that an array is of real numbers."""
    if values.dtype.kind in "fiub":
        return None
    return f"returned {array(values)}, not of real numbers"


def all_finite(values: Any) -> bool:
    """Tell whether every number of an array is finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        # One sum costs less than looking at every number, and seldom overflows.
        return bool(np.isfinite(values.sum())) or bool(np.isfinite(values).all())


def fields(what: str, *found: tuple[str, Any, bool, str]) -> str | None:
    """Return the first field that is not right, if any: (name, value, whether right, wanted)."""
    for name, value, right, wanted in found:
        if not right:
            return f"returned {what} whose {name} is {shown(value)}, not {wanted}"
    return None


def whole(value: object) -> bool:
    """Tell whether a value is a whole number, of Python or of numpy."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def number(value: Any) -> bool:
    """Tell whether a value is a finite number, of Python or of numpy."""
    return isinstance(value, Real) and isfinite(value)


def shown(value: object) -> str:
    """Return a number or a text as it is, anything else by its type."""
    return repr(value)[:80] if isinstance(value, (int, float, str)) else described(value)


def array(value: object) -> str:
    """Return the type of the numbers of an array; of anything else what it is."""
    return f"an array of {value.dtype}" if isinstance(value, np.ndarray) else described(value)


def counted(number: int, what: str) -> str:
    """Return a number of things."""
    return f"{number} {what}{'' if number == 1 else 's'}"
