"""A whole pipeline as a config: cues with their classifiers, an integrator, folds, unknown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from placecue.components.build import build, construct, describe, named
from placecue.components.hooks import Kind
from placecue.components.nesting import visited_parameters
from placecue.components.registry import Registry
from placecue.errors import UsageError
from placecue.integrator import OnlyCue
from placecue.learning.rejection import Unknown
from placecue.pipeline import Pipeline

#: Kinds of component that no pipeline is made of.
NOT_IN_PIPELINES: frozenset[Kind] = frozenset({"accumulator", "adapter", "boundary", "source"})


def build_pipeline(composition: Mapping[str, Any], registry: Registry) -> Pipeline:
    """Build an unfitted pipeline from its config.

    Parameters
    ----------
    composition : mapping
        ``cues`` (by name, each a cue with its ``classifier``), ``integrator`` (or nothing),
        ``folds`` and ``unknown`` (or nothing).
    registry : Registry
        Builds the components.

    Raises
    ------
    UsageError
        If a component or a parameter is unknown, or a cue has no classifier.
    """
    composition = in_todays_words(composition)
    cues = {}
    for name, spec in (composition.get("cues") or {}).items():
        cue = {key: value for key, value in spec.items() if key != "classifier"}
        where = f"cues.{name}"
        cues[name] = (
            build(cue, "cue", registry, where),
            build(spec.get("classifier"), "classifier", registry, f"{where}.classifier"),
        )
    integrator = composition.get("integrator") or None
    folds = composition.get("folds")
    return Pipeline(
        cues,
        None if integrator is None else build(integrator, "integrator", registry),
        None if folds is None else build(folds, "folds", registry),
        _unknown(composition.get("unknown"), registry),
    )


def in_todays_words(value: Any) -> Any:
    """Return a config of an earlier version as one of today.

    Folds were named by ``scheme`` before they were components named by ``plugin``.
    """
    if isinstance(value, Mapping):
        now = {key: in_todays_words(each) for key, each in value.items()}
        if "scheme" in now and "plugin" not in now:
            now["plugin"] = now.pop("scheme")
        return now
    return [in_todays_words(each) for each in value] if isinstance(value, list) else value


def describe_pipeline(pipeline: Pipeline, registry: Registry) -> dict[str, Any]:
    """Return the config that builds a pipeline anew, the opposite of :func:`build_pipeline`."""
    integrator = pipeline.integrator
    return {
        "cues": {
            name: {
                **describe(model.cue, registry),
                "classifier": describe(model.classifier, registry),
            }
            for name, model in pipeline.cues.items()
        },
        "integrator": None if isinstance(integrator, OnlyCue) else describe(integrator, registry),
        "folds": describe(pipeline.folds, registry),
        "unknown": None if pipeline.unknown is None else asdict(pipeline.unknown),
    }


def components_of(composition: Mapping[str, Any], registry: Registry) -> Iterator[tuple[Kind, str]]:
    """Yield the kind and name of every component that a pipeline's config names."""
    for spec in composition["cues"].values():
        cue = {key: value for key, value in spec.items() if key != "classifier"}
        yield from components_in(cue, "cue", registry)
        yield from components_in(spec["classifier"], "classifier", registry)
    if composition["integrator"]:
        yield from components_in(composition["integrator"], "integrator", registry)
    yield from components_in(composition["folds"], "folds", registry)


def components_in(spec: Any, kind: Kind, registry: Registry) -> list[tuple[Kind, str]]:
    """Return the kind and name of a component and of every one inside it, from its config."""
    if kind in NOT_IN_PIPELINES:
        raise UsageError(f"a pipeline has no place for a component of kind '{kind}'")
    name, parameters = named(spec, kind, registry, kind)
    found = [(kind, name)]
    visited_parameters(
        parameters,
        registry.load(kind, name),
        registry,
        kind,
        lambda inner, of_kind, _: found.extend(components_in(inner, of_kind, registry)),
    )
    return found


def _unknown(config: Any, registry: Registry) -> Unknown | None:
    """Build what asks for "unknown"; None where no rate is given."""
    if config is None:
        return None
    if not isinstance(config, Mapping):
        raise UsageError(
            f"unknown must be a mapping with 'false_accept_rate', or null, got {config!r}; such as "
            "unknown.false_accept_rate=0.05"
        )
    given = {name: value for name, value in config.items() if value is not None}
    unknown: Unknown = construct(Unknown, given, registry, "unknown")
    return unknown if given else None
