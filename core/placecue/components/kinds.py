"""Kinds of component: their interfaces, and what parameters' names and annotations say of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, cast, get_args, get_origin, get_type_hints

from placecue.components.hooks import KINDS, Kind
from placecue.ownership import kind_of_class


def kind_named(parameter: str) -> Kind | None:
    """Return the kind that a parameter is named for, in the singular or plural; else None."""
    for kind in KINDS:
        plural = f"{kind[:-1]}ies" if kind.endswith("y") else f"{kind}s"
        if parameter in (kind, plural):
            return kind
    return None


def hints_of(factory: Any) -> dict[str, Any]:
    """Return the annotations of a component's parameters; none where they cannot be resolved."""
    try:
        return get_type_hints(factory.__init__)
    except (AttributeError, NameError, TypeError):  # such as names imported for checkers only
        return {}


def kinds_in(hint: Any) -> set[Kind]:
    """Return the kinds of component that an annotation names, at any depth."""
    found = (kind_of_class(leaf) for leaf in _leaves(hint))
    return {cast(Kind, kind) for kind in found if kind is not None}


def admits_text(hint: Any) -> bool:
    """Tell whether an annotation names text, at any depth; keys of mappings do not count."""
    return any(leaf is str or isinstance(leaf, str) for leaf in _leaves(hint))


def holds_several(hint: Any) -> bool:
    """Tell whether an annotation is, or may be, a list or a mapping."""
    origin = get_origin(hint)
    if isinstance(origin, type) and issubclass(origin, Collection):
        return True
    return any(holds_several(each) for each in get_args(hint))


def _leaves(hint: Any) -> list[Any]:
    inner = get_args(hint)
    origin = get_origin(hint)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        inner = inner[-1:]
    return [leaf for each in inner for leaf in _leaves(each)] if inner else [hint]
