"""Whether the components that are installed are those that a model was made with."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, cast, get_args

from placecue.components.hooks import Kind
from placecue.components.registry import Registry
from placecue.errors import PluginError, UsageError, choices

log = logging.getLogger(__name__)

#: What to do with a model whose components have another version than the installed ones.
OtherVersions = Literal["refuse", "warn"]


def plugins_of(components: Iterable[tuple[Kind, str]], registry: Registry) -> list[dict[str, str]]:
    """Return what a manifest says of components: who brought them, and in which version.

    ``version`` is that of the distribution; ``component_version`` that of the component alone,
    which changes when its results do.
    """
    provided = (registry.get(*named) for named in sorted(set(components)))
    return [
        {
            "kind": each.component.kind,
            "name": each.component.name,
            "distribution": each.distribution,
            "version": each.version,
            "component_version": version_of(each.component.kind, each.component.name, registry),
        }
        for each in provided
    ]


def version_of(kind: Kind, name: str, registry: Registry) -> str:
    """Return the version of an installed component; "1" where it says none."""
    return str(getattr(registry.load(kind, name), "version", "1"))


def check_installed(
    plugins: Sequence[Mapping[str, Any]],
    registry: Registry,
    folder: Path,
    other_versions: OtherVersions,
) -> None:
    """Compare what a model was made with and what is installed.

    Raises
    ------
    PluginError
        If a component is not installed, or, unless ``other_versions`` is "warn", in another
        version.
    UsageError
        If ``other_versions`` is neither "refuse" nor "warn".
    """
    if other_versions not in get_args(OtherVersions):
        raise UsageError(
            f"other_versions must be refuse or warn, got {other_versions!r}; "
            f"{choices(str(other_versions), get_args(OtherVersions))}"
        )
    for plugin in plugins:
        kind, name = cast(Kind, plugin["kind"]), plugin["name"]
        if name not in registry.names(kind):
            raise PluginError(
                f"the model {folder} needs {kind} '{name}' of the plugin "
                f"{plugin['distribution']} {plugin['version']}, which is not installed or did not "
                f"load: pip install {plugin['distribution']}, then see placecue plugins"
            )
    others = [each for each in plugins if _is_other(each, registry)]
    if not others:
        return
    said = f"the model {folder} was made with {'; '.join(_said(each, registry) for each in others)}"
    if other_versions == "refuse":
        raise PluginError(
            f"{said}: results would differ; train it again, install the plugin's version of then, "
            "or take it all the same with other_versions=warn"
        )
    log.warning(f"{said}: results may differ from those of the model as it was trained")


def _is_other(plugin: Mapping[str, Any], registry: Registry) -> bool:
    installed = version_of(cast(Kind, plugin["kind"]), plugin["name"], registry)
    return bool(plugin["component_version"] != installed)


def _said(plugin: Mapping[str, Any], registry: Registry) -> str:
    kind, name = cast(Kind, plugin["kind"]), plugin["name"]
    provided = registry.get(kind, name)
    return (
        f"{kind} '{name}' of version {plugin['component_version']} ({plugin['distribution']} "
        f"{plugin['version']}), and version {version_of(kind, name, registry)} is installed "
        f"({provided.distribution} {provided.version})"
    )
