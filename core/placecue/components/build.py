"""From configs to components, and back.

A component in a config is a mapping with the name it is registered under, and its parameters::

    plugin: svm
    C: 10
    kernel: {plugin: chi2, gamma: 2.0}
    scaling: quantiles

A parameter that is itself such a mapping is built first and handed in, also inside lists and
mappings; where the parameter can only be a component, its bare name stands for the mapping.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

from placecue.components.hooks import Kind
from placecue.components.nesting import SEARCH, visited_parameters
from placecue.components.parameter_types import misfits
from placecue.components.registry import Registry
from placecue.errors import FOREIGN, PlacecueError, PluginError, UsageError, choices, told
from placecue.guard import call


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
    spec : mapping or str
        ``plugin`` and parameters, OmegaConf or plain; or the bare name.
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
    where = where or kind
    name, parameters = named(spec, kind, registry, where)
    factory = registry.load(kind, name)
    by = registry.get(kind, name)
    owner = f"{by.distribution} {by.version}"
    return construct(factory, parameters, registry, where, f"{where}: {kind} '{name}'", owner)


def named(spec: Any, kind: Kind, registry: Registry, where: str) -> tuple[str, dict[str, Any]]:
    """Take a component's config apart into its name and its parameters.

    Raises
    ------
    UsageError
        If it is no such config.
    """
    spec = plain(spec)
    if isinstance(spec, str):
        return spec, {}
    if not isinstance(spec, Mapping) or "plugin" not in spec:
        raise UsageError(
            f"{where} must be a mapping with 'plugin' and parameters, got {spec!r}; "
            f"{choices('', registry.names(kind))}"
        )
    parameters = dict(spec)
    return str(parameters.pop("plugin")), parameters


def construct(
    factory: Any,
    parameters: Mapping[str, Any],
    registry: Registry,
    where: str,
    what: str = "",
    owner: str = "",
) -> Any:
    """Build what a factory makes of parameters, the components in them built first.

    Parameters
    ----------
    factory : class
        What is built.
    parameters : mapping
        Its parameters, plain. In ``search``, what is null is not searched.
    registry : Registry
        Builds the components in them.
    where : str
        Where in the config it stands, for messages.
    what : str
        How messages begin; by default with where it stands.
    owner : str
        The distribution that brought it, with its version, where that is known.

    Raises
    ------
    UsageError
        If a parameter is unknown, or a value is refused.
    """
    what = what or where
    _check_names(parameters, factory, what)
    built = visited_parameters(
        _without_unsearched(parameters),
        factory,
        registry,
        where,
        lambda spec, kind, place: build(spec, kind, registry, place),
    )
    wrong = misfits(built, factory)
    if wrong:
        raise UsageError(f"{what}: {'; '.join(wrong)}")
    try:
        made = factory(**built)
        getattr(made, "check_parameters", lambda: None)()
    except PlacecueError:
        raise
    except (TypeError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise UsageError(f"{what} refused its parameters: {reason}") from error
    except FOREIGN as error:
        by = f" ({owner})" if owner else ""
        raise PluginError(f"{what}{by} cannot be made: {told(error)}") from error
    return made


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
    for name, value in call(component, "get_params", deep=False).items():
        spec[name] = _described(value, registry)
    return spec


def parameters_of(factory: Any) -> dict[str, inspect.Parameter]:
    """Return the parameters that a component takes, by name."""
    return dict(inspect.signature(factory).parameters)


def _described(value: Any, registry: Registry) -> Any:
    """Return a parameter's value with every component in it as a config."""
    if hasattr(value, "get_params"):
        return describe(value, registry)
    if isinstance(value, Mapping):
        return {key: _described(each, registry) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        items = [_described(each, registry) for each in value]
        return items if any(a is not b for a, b in zip(items, value, strict=True)) else value
    return value


def _without_unsearched(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters with what is null taken out of ``search``."""
    found = dict(parameters)
    if isinstance(found.get(SEARCH), Mapping):
        found[SEARCH] = {n: tried for n, tried in found[SEARCH].items() if tried is not None}
    return found


def _check_names(parameters: Mapping[str, Any], factory: Any, what: str) -> None:
    known = parameters_of(factory)
    if any(each.kind is inspect.Parameter.VAR_KEYWORD for each in known.values()):
        return
    for parameter in parameters:
        if parameter in known:
            continue
        inside = [
            f"{name}.{parameter}"
            for name, value in parameters.items()
            if isinstance(value, Mapping) and parameter in value
        ]
        near = f"did you mean {' or '.join(inside)}?" if inside else choices(parameter, known)
        raise UsageError(f"{what} has no parameter '{parameter}'; {near}")
