"""What a component has learned, as JSON and arrays; never as code.

Learned attributes are those whose names end in ``_``. They may be numbers, strings, lists,
mappings, arrays, sparse matrices, descriptor sets, layouts, and other components. Names that begin
with ``_`` are for what is worked out from these, and are not kept.

A component that can tell whether what it was given fits together may have a method
``check_learned()``, which raises ValueError where it does not; it is called after each reading.
"""

from __future__ import annotations

import inspect
from collections.abc import Collection, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator

from placecue.components.build import build, describe
from placecue.components.hooks import Kind
from placecue.components.pipelines import components_in
from placecue.components.registry import Registry
from placecue.errors import FOREIGN, DataError, UsageError, told
from placecue.ownership import provenance
from placecue.scores import Layout
from placecue.storage.arrays import KINDS, from_parts, parts_of

Arrays = dict[str, NDArray[Any]]
_T = TypeVar("_T")


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
    components : set of (str, str)
        Kinds and names of the components among what was learned, and of those inside them.
    """

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.arrays: Arrays = {}
        self.components: set[tuple[Kind, str]] = set()

    def state(self, component: object, where: str) -> dict[str, Any]:
        """Return what a component has learned.

        Raises
        ------
        UsageError
            If it has set an attribute that is neither a parameter nor called as what is learned,
            or has learned what a model folder cannot hold.
        """
        _check_names(component, where)
        try:
            return {
                name: self.encode(value, f"{where}.{name}")
                for name, value in sorted(learned(component).items())
            }
        except RecursionError as error:
            raise UsageError(
                f"{where} has learned what holds itself, or is nested too deep for a model folder: "
                "keep learned state as lists and mappings of a few levels"
            ) from error

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
        self.components |= set(components_in(spec, kind, self.registry))
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
        return {**what, "parts": {part: self._aside(array) for part, array in parts.items()}}

    def _aside(self, array: NDArray[Any]) -> dict[str, Any]:
        name = f"a{len(self.arrays)}"
        self.arrays[name] = array
        return {"array": name, **_described(array)}


class Decoder:
    """Turns what :class:`Encoder` wrote back into learned attributes, and checks it.

    Parameters
    ----------
    registry : Registry
        Builds components.
    arrays : mapping of str to ndarray
        The arrays put aside.
    components : collection of (str, str), optional
        Kinds and names of the components that may be built; by default all of the kinds that a
        model is made of.

    Attributes
    ----------
    used : set of str
        Names of the arrays that were asked for.
    """

    def __init__(
        self,
        registry: Registry,
        arrays: Mapping[str, NDArray[Any]],
        components: Collection[tuple[str, str]] | None = None,
    ) -> None:
        self.registry = registry
        self.arrays = arrays
        self.components = components
        self.used: set[str] = set()

    def restore(self, component: object, state: Any) -> None:
        """Give a component what it had learned.

        Raises
        ------
        DataError
            If that is damaged, or no state of this component.
        """
        for name, value in _a(dict, state, "a state").items():
            if not _may_be_set(component, name):
                raise DataError(f"the model sets '{name}', which is no learned attribute")
            setattr(component, name, self.decode(value))
        check = getattr(component, "check_learned", None)
        if check is not None:
            try:
                check()
            except FOREIGN as error:  # it is a plugin's
                raise DataError(
                    f"what {provenance(component)} has learned does not fit together: {told(error)}"
                ) from error

    def decode(self, value: Any) -> Any:
        """Return one value."""
        if isinstance(value, list):
            return [self.decode(item) for item in value]
        if not isinstance(value, dict):
            return value
        kind = value.get("@")
        if kind == "tuple":
            return tuple(self.decode(item) for item in _a(list, value["items"], kind))
        if kind == "mapping":
            items = _a(dict, value["items"], kind)
            return {key: self.decode(item) for key, item in items.items()}
        if kind == "component":
            return self.component(value["spec"], value["kind"], value["state"])
        return self._array(kind, value)

    def component(self, spec: Mapping[str, Any], kind: Kind, state: Mapping[str, Any]) -> Any:
        """Build a component and give it what it had learned."""
        self._check_components(spec, kind)
        component = build(spec, kind, self.registry)
        self.restore(component, state)
        return component

    def _check_components(self, spec: Mapping[str, Any], kind: Kind) -> None:
        for each in components_in(spec, kind, self.registry):
            if self.components is not None and each not in self.components:
                raise DataError(
                    f"the model has learned {each[0]} '{each[1]}', which its manifest does not name"
                )

    def _array(self, kind: Any, value: Mapping[str, Any]) -> Any:
        if kind not in KINDS:
            raise DataError(f"the model holds a value of unknown kind {kind!r:.80}")
        parts = _a(dict, value["parts"], kind)
        return from_parts(value, {part: self._taken(each) for part, each in parts.items()})

    def _taken(self, what: Mapping[str, Any]) -> NDArray[Any]:
        name = _a(str, what["array"], "the name of an array")
        if name in self.used:
            raise DataError(f"the model uses array {name!r:.80} twice")
        if name not in self.arrays:
            raise DataError(f"the model lacks array {name!r:.80}")
        self.used.add(name)
        array = self.arrays[name]
        said = {key: what.get(key) for key in _described(array)}
        if said != _described(array):
            raise DataError(
                f"array {name!r:.80} is {_described(array)}, and the model has learned {said}"
            )
        return array


def _described(array: NDArray[Any]) -> dict[str, Any]:
    """Return what is said of an array beside its name."""
    finite = array.dtype.kind != "f" or bool(np.isfinite(array).all())
    return {"dtype": array.dtype.str, "shape": list(array.shape), "finite": finite}


def _check_names(component: object, where: str) -> None:
    parameters: Collection[str] = ()
    if hasattr(component, "get_params"):
        parameters = component.get_params(deep=False)
    for name in vars(component):
        if not name.startswith("_") and not name.endswith("_") and name not in parameters:
            raise UsageError(
                f"{where}.{name} is neither a parameter nor called as what is learned, so it would "
                f"be lost: call it {name}_, or _{name} if it is worked out from the others"
            )


def _may_be_set(component: object, name: str) -> bool:
    """Tell whether a name is that of a learned attribute, and of no method or property."""
    if not name.endswith("_") or name.startswith("_"):
        return False
    own = inspect.getattr_static(type(component), name, None)
    return own is None or not (callable(own) or hasattr(own, "__get__"))


def _a(kind: type[_T], value: Any, what: object) -> _T:
    if not isinstance(value, kind):
        raise DataError(f"the model holds {value!r:.80} in place of {what}")
    return value
