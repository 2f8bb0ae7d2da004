"""A whole pipeline as a config: cues with their classifiers, an integrator, folds, unknown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from placecue.components.build import build, describe, kind_of_parameter, nested
from placecue.components.hooks import Kind
from placecue.components.parameter_types import misfits
from placecue.components.registry import Registry
from placecue.errors import UsageError, choices
from placecue.folds import FOLD_SCHEMES, fold_scheme
from placecue.integrator import OnlyCue
from placecue.learning.rejection import Unknown
from placecue.pipeline import Pipeline


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
        If a component, a parameter or the fold scheme is unknown, or a cue has no classifier.
    """
    cues = {}
    for name, spec in (composition.get("cues") or {}).items():
        cue = {key: value for key, value in spec.items() if key != "classifier"}
        where = f"cues.{name}"
        cues[name] = (
            build(cue, "cue", registry, where),
            build(spec.get("classifier"), "classifier", registry, f"{where}.classifier"),
        )
    integrator = composition.get("integrator") or None
    return Pipeline(
        cues,
        None if integrator is None else build(integrator, "integrator", registry),
        fold_scheme(composition.get("folds")),
        build_unknown(composition.get("unknown")),
    )


def build_unknown(config: Mapping[str, Any] | None) -> Unknown | None:
    """Build what asks for "unknown" from ``false_accept_rate``; None where that is null."""
    if config is None:
        return None
    if not isinstance(config, Mapping):
        raise UsageError(
            f"unknown must be a mapping with 'false_accept_rate', or null, got {config!r}; such as "
            "unknown.false_accept_rate=0.05"
        )
    known = Unknown.__dataclass_fields__
    for parameter in config:
        if parameter not in known:
            raise UsageError(f"unknown has no parameter '{parameter}'; {choices(parameter, known)}")
    given = {name: value for name, value in config.items() if value is not None}
    wrong = misfits(given, Unknown)
    if wrong:
        raise UsageError(f"unknown: {'; '.join(wrong)}")
    return Unknown(**given) if given else None


def describe_pipeline(pipeline: Pipeline, registry: Registry) -> dict[str, Any]:
    """Return the config that builds a pipeline anew, the opposite of :func:`build_pipeline`."""
    integrator = pipeline.integrator
    scheme = next(name for name, kind in FOLD_SCHEMES.items() if kind is type(pipeline.folds))
    return {
        "cues": {
            name: {
                **describe(model.cue, registry),
                "classifier": describe(model.classifier, registry),
            }
            for name, model in pipeline.cues.items()
        },
        "integrator": None if isinstance(integrator, OnlyCue) else describe(integrator, registry),
        "folds": {"scheme": scheme, **asdict(pipeline.folds)},
        "unknown": None if pipeline.unknown is None else asdict(pipeline.unknown),
    }


def components_of(composition: Mapping[str, Any], registry: Registry) -> Iterator[tuple[Kind, str]]:
    """Yield the kind and name of every component that a pipeline's config names."""
    for spec in composition["cues"].values():
        yield from components_in(spec, "cue", registry)
    if composition["integrator"]:
        yield from components_in(composition["integrator"], "integrator", registry)


def components_in(
    spec: Mapping[str, Any], kind: Kind, registry: Registry
) -> Iterator[tuple[Kind, str]]:
    """Yield the kind and name of a component and of every one inside it, from its config."""
    yield kind, spec["plugin"]
    for name, value in spec.items():
        for each in nested(value):
            yield from components_in(each, kind_of_parameter(name, each, registry), registry)
