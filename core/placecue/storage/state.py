"""What a component has learned, as JSON and arrays; never as code.

Learned attributes are those whose names end in ``_``. They may be numbers, strings, lists,
mappings, arrays, sparse matrices, descriptor sets, layouts, and other components.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator

from placecue.components.build import build, describe
from placecue.components.hooks import Kind
from placecue.components.registry import Registry
from placecue.errors import DataError, UsageError
from placecue.scores import Layout
from placecue.storage.arrays import KINDS, from_parts, parts_of

Arrays = dict[str, NDArray[Any]]


def learned(component: object) -> dict[str, Any]:
    """Return the learned attributes of a component by name."""
    return {
        name: value
        for name, value in vars(component).items()
        if name.endswith("_") and not name.startswith("_")
    }


class Encoder:
    """Turns learned attributes into JSON, putting arrays aside under numbered names.

    Parameters
    ----------
    registry : Registry
        Names components.

    Attributes
    ----------
    arrays : dict of str to ndarray
        The arrays put aside.
    """

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.arrays: Arrays = {}

    def state(self, component: object, where: str) -> dict[str, Any]:
        """Return what a component has learned."""
        return {
            name: self.encode(value, f"{where}.{name}")
            for name, value in sorted(learned(component).items())
        }

    def encode(self, value: Any, where: str) -> Any:
        """Return one value as JSON.

        Raises
        ------
        UsageError
            If it is nothing that a model folder can hold.
        """
        if value is None or isinstance(value, (bool, int, float, str)):
            return value
        if isinstance(value, np.generic):
            return value.item()
        if isinstance(value, (list, tuple)):
            items = [self.encode(item, f"{where}.{i}") for i, item in enumerate(value)]
            return items if isinstance(value, list) else {"@": "tuple", "items": items}
        if isinstance(value, Mapping):
            if not all(isinstance(key, str) for key in value):
                raise UsageError(
                    f"{where} is a mapping with keys that are no text, which a model folder "
                    "cannot hold: keep learned state under names"
                )
            items_of = {k: self.encode(v, f"{where}.{k}") for k, v in value.items()}
            return {"@": "mapping", "items": items_of}
        if isinstance(value, (BaseEstimator, Layout)):
            return self._component(value, where)
        return self._array(value, where)

    def _component(self, value: Any, where: str) -> dict[str, Any]:
        provided = self.registry.find(value)
        spec = describe(value, self.registry)
        assert provided is not None
        kind = provided.component.kind
        return {"@": "component", "kind": kind, "spec": spec, "state": self.state(value, where)}

    def _array(self, value: Any, where: str) -> dict[str, Any]:
        taken_apart = parts_of(value)
        if taken_apart is None:
            raise UsageError(
                f"{where} is a {type(value).__name__}, which a model folder cannot hold: keep "
                "learned state as numbers, strings, lists, mappings, arrays, layouts or registered "
                "components"
            )
        what, parts = taken_apart
        names = {part: f"a{len(self.arrays) + i}" for i, part in enumerate(parts)}
        self.arrays.update({names[part]: array for part, array in parts.items()})
        return {**what, **names}


class Decoder:
    """Turns what :class:`Encoder` wrote back into learned attributes.

    Parameters
    ----------
    registry : Registry
        Builds components.
    arrays : mapping of str to ndarray
        The arrays put aside.
    """

    def __init__(self, registry: Registry, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.registry = registry
        self.arrays = arrays

    def restore(self, component: object, state: Mapping[str, Any]) -> None:
        """Give a component what it had learned."""
        for name, value in state.items():
            if not name.endswith("_") or name.startswith("_"):
                raise DataError(f"the model sets '{name}', which is no learned attribute")
            setattr(component, name, self.decode(value))

    def decode(self, value: Any) -> Any:
        """Return one value."""
        if isinstance(value, list):
            return [self.decode(item) for item in value]
        if not isinstance(value, dict):
            return value
        kind = value.get("@")
        if kind == "tuple":
            return tuple(self.decode(item) for item in value["items"])
        if kind == "mapping":
            return {key: self.decode(item) for key, item in value["items"].items()}
        if kind == "component":
            return self.component(value["spec"], value["kind"], value["state"])
        return self._array(kind, value)

    def component(self, spec: Mapping[str, Any], kind: Kind, state: Mapping[str, Any]) -> Any:
        """Build a component and give it what it had learned."""
        component = build(spec, kind, self.registry)
        self.restore(component, state)
        return component

    def _array(self, kind: Any, value: Mapping[str, Any]) -> Any:
        if kind not in KINDS:
            raise DataError(f"the model holds a value of unknown kind {kind!r}")
        names = {part: name for part, name in value.items() if isinstance(name, str)}
        return from_parts(value, {p: self.arrays[n] for p, n in names.items() if p != "@"})
