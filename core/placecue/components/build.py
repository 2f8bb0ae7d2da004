"""From configs to components, and back.

A component in a config is a mapping with the name it is registered under, and its parameters::

    plugin: svm
    C: 10
    kernel: {plugin: chi2, gamma: 2.0}

A parameter that is itself such a mapping, or a list of them, is built first and handed in.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

from placecue.components.hooks import KINDS, Kind
from placecue.components.parameter_types import misfits
from placecue.components.registry import Registry
from placecue.errors import FOREIGN, PlacecueError, PluginError, UsageError, choices, told


def plain(value: Any) -> Any:
    """Convert OmegaConf containers, at any depth, to resolved plain Python."""
    from omegaconf import Container, OmegaConf

    if isinstance(value, Container):
        return OmegaConf.to_container(value, resolve=True, throw_on_missing=True)
    return value


def build(spec: Any, kind: Kind, registry: Registry, where: str = "") -> Any:
    """Build a component from its config.

    Parameters
    ----------
    spec : mapping
        ``plugin`` and parameters; OmegaConf or plain.
    kind : str
        What is wanted.
    registry : Registry
        What there is.
    where : str
        Where in the config it stands, for messages.

    Returns
    -------
    object
        The component.

    Raises
    ------
    UsageError
        If the name or a parameter is unknown, or a value is refused.
    """
    spec = plain(spec)
    where = where or kind
    if not isinstance(spec, Mapping) or "plugin" not in spec:
        raise UsageError(
            f"{where} must be a mapping with 'plugin' and parameters, got {spec!r}; "
            f"{choices('', registry.names(kind))}"
        )
    parameters = dict(spec)
    name = str(parameters.pop("plugin"))
    factory = registry.load(kind, name)
    _check_parameters(parameters, factory, kind, name, where)
    built = {
        key: _built(value, key, registry, f"{where}.{key}") for key, value in parameters.items()
    }
    wrong = misfits(built, factory)
    if wrong:
        raise UsageError(f"{where}: {kind} '{name}': {'; '.join(wrong)}")
    try:
        return factory(**built)
    except PlacecueError:
        raise
    except (TypeError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise UsageError(f"{where}: {kind} '{name}' refused its parameters: {reason}") from error
    except FOREIGN as error:
        raise PluginError(f"{where}: {kind} '{name}' cannot be made: {told(error)}") from error


def describe(component: Any, registry: Registry) -> dict[str, Any]:
    """Return the config that builds a component anew, the opposite of :func:`build`.

    Raises
    ------
    UsageError
        If the component, or one inside it, is not a registered one.
    """
    provided = registry.find(component)
    if provided is None:
        raise UsageError(
            f"{type(component).__module__}.{type(component).__qualname__} is no registered "
            "component, so a model folder cannot name it: register it as a plugin"
        )
    spec: dict[str, Any] = {"plugin": provided.component.name}
    for name, value in component.get_params(deep=False).items():
        spec[name] = _described(value, registry)
    return spec


def parameters_of(factory: Any) -> dict[str, inspect.Parameter]:
    """Return the parameters that a component takes, by name."""
    return dict(inspect.signature(factory).parameters)


def is_component(value: Any) -> bool:
    """Tell whether a config value is a component."""
    return isinstance(value, Mapping) and "plugin" in value


def nested(value: Any) -> list[Mapping[str, Any]]:
    """Return the components in a config value: one, those of a list, or none."""
    if is_component(value):
        return [value]
    if isinstance(value, (list, tuple)) and all(map(is_component, value)):
        return list(value)
    return []


def kind_of_parameter(parameter: str, spec: Mapping[str, Any], registry: Registry) -> Kind:
    """Tell what kind a nested component is of: by the parameter's name, else by its own.

    A list of components may stand under the plural, such as ``kernels``.
    """
    for kind in KINDS:
        if parameter in (kind, f"{kind}s"):
            return kind
    name = str(spec["plugin"])
    kinds = registry.kinds_of(name)
    if len(kinds) == 1:
        return kinds[0]
    known = f"it is a {' and a '.join(kinds)}" if kinds else "no component has that name"
    raise UsageError(
        f"cannot tell what kind of component '{name}' of parameter '{parameter}' is: {known}"
    )


def _built(value: Any, parameter: str, registry: Registry, where: str) -> Any:
    """Return a parameter's value with its component, or list of components, built."""
    components = [
        build(each, kind_of_parameter(parameter, each, registry), registry, where)
        for each in nested(value)
    ]
    if not components:
        return value
    return components[0] if is_component(value) else components


def _described(value: Any, registry: Registry) -> Any:
    """Return a parameter's value with its component, or list of components, as a config."""
    if hasattr(value, "get_params"):
        return describe(value, registry)
    if isinstance(value, (list, tuple)) and any(hasattr(each, "get_params") for each in value):
        return [_described(each, registry) for each in value]
    return value


def _check_parameters(
    parameters: Mapping[str, Any], factory: Any, kind: Kind, name: str, where: str
) -> None:
    known = parameters_of(factory)
    if any(each.kind is inspect.Parameter.VAR_KEYWORD for each in known.values()):
        return
    for parameter in parameters:
        if parameter not in known:
            raise UsageError(
                f"{where}: {kind} '{name}' has no parameter '{parameter}'; "
                f"{choices(parameter, known)}"
            )
