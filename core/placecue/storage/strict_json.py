"""JSON that may have come from anybody: each key once, numbers that are numbers, not too deep.

Floats that JSON has no word for (NaN and infinite ones) are written as ``{"@": "number", …}``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from placecue.errors import DataError

#: Levels of lists and mappings inside one another.
DEPTH = 100
#: Digits of a whole number; those of 128 bits have 39.
DIGITS = 40
_WORDS = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}


def dumps(data: Any) -> bytes:
    """Return plain data as JSON that :func:`loads` reads back."""
    text = json.dumps(_in_words(data), indent=2, ensure_ascii=False, allow_nan=False)
    return (text + "\n").encode()


def loads(data: bytes, what: object) -> Any:
    """Read JSON.

    Parameters
    ----------
    data : bytes
        The text.
    what : object
        What is read, for messages.

    Raises
    ------
    DataError
        If it is no such JSON.
    """
    try:
        text = data.decode("utf-8")
        value = json.loads(
            text,
            object_pairs_hook=_mapping,
            parse_constant=_refused,
            parse_int=_whole,
            parse_float=_finite,
        )
        if "\\u" in text:  # halves of characters, which can be written nowhere
            json.dumps(value, ensure_ascii=False).encode()
    except RecursionError as error:
        raise DataError(f"{what} is damaged: it is nested too deep") from error
    except ValueError as error:
        raise DataError(f"{what} is damaged: {error!s:.200}") from error
    if _deeper_than(value, DEPTH):
        raise DataError(f"{what} is damaged: it is nested deeper than {DEPTH} levels")
    return value


def _mapping(pairs: list[tuple[str, Any]]) -> Any:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("a key stands twice in one mapping")
    if found.get("@") == "number":
        return _WORDS.get(str(found.get("value")), found)
    return found


def _in_words(data: Any) -> Any:
    if isinstance(data, float) and not math.isfinite(data):
        return {"@": "number", "value": str(float(data))}
    if isinstance(data, Mapping):
        return {key: _in_words(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_in_words(value) for value in data]
    return data


def _refused(word: str) -> Any:
    raise ValueError(f"{word} is no number")


def _whole(digits: str) -> int:
    if len(digits) > DIGITS:
        raise ValueError(f"a whole number has {len(digits)} digits")
    return int(digits)


def _finite(digits: str) -> float:
    number = float(digits)
    if not math.isfinite(number):
        raise ValueError(f"{digits:.40} is too large a number")
    return number


def _deeper_than(value: Any, depth: int) -> bool:
    level = [value]
    for _ in range(depth):
        level = [child for each in level for child in _children(each)]
        if not level:
            return False
    return True


def _children(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return list(value.values())
    return value if isinstance(value, list) else []
