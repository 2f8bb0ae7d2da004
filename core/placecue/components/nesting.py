"""Where components stand inside others, in parameters, lists and mappings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from placecue.components.hooks import Kind
from placecue.components.kinds import admits_text, hints_of, kind_named, kinds_in
from placecue.components.registry import Registry
from placecue.errors import UsageError

#: The parameter that lists values to try of others, by their names.
SEARCH = "search"

#: Does something with a component of a kind, given as a mapping, and where it stands.
Visit = Callable[[Mapping[str, Any], Kind, str], Any]


def is_component(value: Any) -> bool:
    """Tell whether a config value is a component, written as a mapping."""
    return isinstance(value, Mapping) and "plugin" in value


@dataclass(frozen=True)
class Slot:
    """A parameter, or a place in its lists and mappings, where components may stand.

    Parameters
    ----------
    name : str
        The parameter.
    registry : Registry
        What there is.
    where : str
        Where in the config it stands, for messages.
    hint : object
        The parameter's annotation; None where there is none.
    is_tried : bool
        Whether it lists values to try of another parameter.
    """

    name: str
    registry: Registry
    where: str
    hint: Any = None
    is_tried: bool = False

    def kind(self, plugin: str) -> Kind:
        """Return the kind of a component: by annotation, the parameter's name, or its own.

        Raises
        ------
        UsageError
            If none of them tells.
        """
        annotated = kinds_in(self.hint)
        if len(annotated) == 1:
            return next(iter(annotated))
        named = kind_named(self.name)
        if named is not None:
            return named
        kinds = self.registry.kinds_of(plugin)
        fitting = [kind for kind in kinds if kind in annotated] or kinds
        if len(fitting) == 1:
            return fitting[0]
        known = f"it is a {' and a '.join(kinds)}" if kinds else "no component has that name"
        raise UsageError(
            f"{self.where}: cannot tell what kind of component '{plugin}' of parameter "
            f"'{self.name}' is: {known}"
        )

    def shorthand(self, text: str) -> Kind | None:
        """Return the kind of component that a text is the name of; None for a plain text."""
        if admits_text(self.hint):
            return None
        annotated = kinds_in(self.hint)
        if annotated:
            return self.kind(text)
        named = kind_named(self.name)
        if named is None or self.is_tried:
            return named
        # What nothing is said of may be a text after all.
        return named if text in self.registry.names(named) else None

    def item(self, key: Any) -> Slot:
        """Return the place of an item of a list, or of a mapping."""
        return replace(self, where=f"{self.where}.{key}")

    def tried(self, key: Any) -> Slot:
        """Return the place of the values to try of another parameter, such as ``kernel__gamma``."""
        name = str(key).rpartition("__")[2]
        return Slot(name, self.registry, f"{self.where}.{key}", is_tried=True)


def visited(value: Any, slot: Slot, visit: Visit) -> Any:
    """Return a value with every component in it replaced by what ``visit`` returns for it.

    A component is a mapping with ``plugin``, or its bare name where a component is wanted.
    """
    if is_component(value):
        return visit(value, slot.kind(str(value["plugin"])), slot.where)
    if isinstance(value, str):
        kind = slot.shorthand(value)
        return value if kind is None else visit({"plugin": value}, kind, slot.where)
    if isinstance(value, (list, tuple)):
        items = [visited(each, slot.item(i), visit) for i, each in enumerate(value)]
        return items if any(a is not b for a, b in zip(items, value, strict=True)) else value
    if isinstance(value, Mapping):
        inside = slot.tried if slot.name == SEARCH else slot.item
        return {key: visited(each, inside(key), visit) for key, each in value.items()}
    return value


def visited_parameters(
    parameters: Mapping[str, Any], factory: Any, registry: Registry, where: str, visit: Visit
) -> dict[str, Any]:
    """Return the parameters of a component with every component in them visited."""
    hints = hints_of(factory)
    return {
        name: visited(value, Slot(name, registry, f"{where}.{name}", hints.get(name)), visit)
        for name, value in parameters.items()
    }
