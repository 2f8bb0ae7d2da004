"""Whether a config's values fit what parameters are annotated with, before anything is built."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

from placecue.components.kinds import hints_of
from placecue.ownership import kind_of_class

#: Annotations that can be judged, with words for one of them and for many.
PLAIN: dict[Any, tuple[str, str]] = {
    float: ("a number", "numbers"),
    int: ("a whole number", "whole numbers"),
    bool: ("true or false", "true or false"),
    str: ("text", "texts"),
    NoneType: ("null", "nulls"),
}


def misfits(parameters: Mapping[str, Any], factory: Any) -> list[str]:
    """Describe the values that parameters cannot take, such as ``C must be a number, got 'x'``.

    Parameters
    ----------
    parameters : mapping
        Values by the name of the parameter.
    factory : class
        Whose constructor takes them; a parameter without an annotation takes everything.
    """
    hints = hints_of(factory)
    return [
        f"{name} must be {in_words(hints[name])}, got {value!r}"
        for name, value in parameters.items()
        if name in hints and not fits(value, hints[name])
    ]


def fits(value: Any, hint: Any) -> bool:
    """Tell whether a value fits an annotation; True where that cannot be told."""
    inner = get_args(hint)
    if _is_union(hint):
        return any(fits(value, each) for each in inner)
    if isinstance(value, bool) and hint in (int, float):
        return False
    if hint is float:
        return isinstance(value, (int, float))
    if hint in PLAIN:
        return isinstance(value, hint)
    if _is_a(hint, Mapping):
        return isinstance(value, Mapping) and all(fits(v, inner[-1]) for v in value.values())
    if _is_a(hint, Sequence):
        return isinstance(value, (list, tuple)) and all(fits(v, inner[0]) for v in value)
    return not hasattr(hint, "get_params") or isinstance(value, hint)  # a component, or unknown


def in_words(hint: Any, many: bool = False) -> str:
    """Describe an annotation for a person, such as ``a list of numbers or null``."""
    inner = get_args(hint)
    if _is_union(hint):
        return " or ".join(in_words(each, many) for each in inner)
    if hint is Any:
        return "values" if many else "a value"
    if hint in PLAIN:
        return PLAIN[hint][many]
    if _is_a(hint, Mapping):
        return f"{'mappings' if many else 'a mapping'} of {in_words(inner[-1], many=True)}"
    if _is_a(hint, Sequence):
        return f"{'lists' if many else 'a list'} of {in_words(inner[0], many=True)}"
    name = kind_of_class(hint) or getattr(hint, "__name__", str(hint)).lower()
    if name.endswith("s"):  # folds
        return name if many else f"{name} such as {{plugin: NAME}}"
    article = "an" if name[0] in "aeiou" else "a"
    return f"{name}s" if many else f"{article} {name} such as {{plugin: NAME}}"


def _is_union(hint: Any) -> bool:
    return get_origin(hint) in (Union, UnionType)


def _is_a(hint: Any, kind: type) -> bool:
    origin = get_origin(hint)
    # A tuple may hold something else at each place, so it is not judged.
    return isinstance(origin, type) and issubclass(origin, kind) and origin is not tuple
