"""How Hydra finds the options of plugins.

Four things are registered with Hydra in-process: a search-path plugin that appends the config
paths which plugins bring, a config source that makes an option for every component without a YAML
file, from its parameters' defaults, one that gives the options of cues as parts of a cue, and one
that lets several boundaries be chosen.
"""

from __future__ import annotations

import inspect
import logging
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any, ClassVar

from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.object_type import ObjectType
from hydra.core.plugins import Plugins as HydraPlugins
from hydra.plugins.config_source import ConfigResult, ConfigSource
from hydra.plugins.search_path_plugin import SearchPathPlugin
from omegaconf import DictConfig, OmegaConf

from placecue.components.build import parameters_of
from placecue.components.hooks import KINDS, Kind
from placecue.components.kinds import admits_text, hints_of, holds_several, kind_named, kinds_in
from placecue.components.manager import current_plugins
from placecue.components.registry import Registry
from placecue.errors import UsageError

log = logging.getLogger(__name__)

BUILT_IN_CONFIGS = "pkg://placecue_conf"
#: What a cue brings where nobody has written an option for it.
DEFAULT_CLASSIFIER = "svm_searched"
#: The kinds that a config chooses among; of the others placecue takes what fits.
OPTION_KINDS: tuple[Kind, ...] = tuple(k for k in KINDS if k not in ("layout", "adapter"))


class PluginOptions(SearchPathPlugin):
    """Appends the config paths of plugins, after placecue's own."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:  # noqa: D102
        for path, distribution in current_plugins().config_paths.items():
            search_path.append(provider=distribution, path=path)
        search_path.append(provider="placecue-defaults", path="component://")
        search_path.append(provider="placecue-parts", path="parts://")
        search_path.append(provider="placecue-boundaries", path="boundaries://")


class ComponentOptions(ConfigSource):
    """Options ``KIND/NAME`` made from the parameters of a component."""

    groups: ClassVar[tuple[str, ...]] = OPTION_KINDS

    @staticmethod
    def scheme() -> str:  # noqa: D102
        return "component"

    def available(self) -> bool:  # noqa: D102
        return True

    def is_group(self, config_path: str) -> bool:  # noqa: D102
        return config_path.strip("/") in ("", *self.groups)

    def is_config(self, config_path: str) -> bool:  # noqa: D102
        kind, _, name = config_path.strip("/").removesuffix(".yaml").partition("/")
        return kind in OPTION_KINDS and name in current_plugins().registry.names(kind)

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:  # noqa: D102
        kind = config_path.strip("/")
        if kind == "":
            return [] if results_filter is ObjectType.CONFIG else sorted(self.groups)
        if kind not in OPTION_KINDS or results_filter is ObjectType.GROUP:
            return []
        return current_plugins().registry.names(kind)

    def load_config(self, config_path: str) -> ConfigResult:  # noqa: D102
        kind, _, name = config_path.strip("/").removesuffix(".yaml").partition("/")
        option = default_option(kind, name)  # type: ignore[arg-type]
        package = f"cues.{name}" if kind == "cue" else kind
        return ConfigResult(
            provider=self.provider,
            path=self.full_path(),
            config=option,
            header={"package": package},
        )


def default_option(kind: Kind, name: str) -> DictConfig:
    """Make an option from a component's parameters: those without a default are ``???``.

    A parameter that takes a component can be given as ``KIND@...PARAMETER=NAME``, as in options
    that are written by hand; a cue brings a classifier.
    """
    registry = current_plugins().registry
    factory = registry.load(kind, name)
    defaults: list[Any] = ["_self_"]
    option: dict[str, Any] = {"defaults": defaults, "plugin": name}
    hints = hints_of(factory)
    for parameter in parameters_of(factory).values():
        if parameter.kind in (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL):
            continue
        taken = _taken(parameter.name, hints.get(parameter.name))
        given = None if taken is None else _name_of(parameter.default, taken, registry)
        if taken is not None:
            defaults.append({f"/{taken}@{parameter.name}": given})
        if given is None:
            missing = parameter.default is inspect.Parameter.empty
            option[parameter.name] = "???" if missing else parameter.default
    if kind == "cue" and "classifier" not in option:
        defaults.append({"/classifier@classifier": DEFAULT_CLASSIFIER})
    try:
        return OmegaConf.create(option)
    except Exception as error:
        raise UsageError(
            f"{kind} '{name}' has a default that a config cannot hold, so it needs an option file "
            f"{kind}/{name}.yaml: {error}"
        ) from error


def _taken(parameter: str, hint: Any) -> Kind | None:
    """Return the kind of the one component that a parameter takes; None where it takes others."""
    annotated = kinds_in(hint)
    kind = next(iter(annotated)) if len(annotated) == 1 else kind_named(parameter)
    several = kind is not None and (parameter not in KINDS and kind_named(parameter) == kind)
    if kind not in OPTION_KINDS or several or holds_several(hint) or admits_text(hint):
        return None
    return kind


def _name_of(default: Any, kind: Kind, registry: Registry) -> str | None:
    """Return the option that gives a parameter's default, where that is a plain component."""
    provided = registry.find(default) if hasattr(default, "get_params") else None
    if provided is None or provided.component.kind != kind:
        return None
    own = {name: each.default for name, each in parameters_of(type(default)).items()}
    return provided.component.name if default.get_params(deep=False) == own else None


def register_with_hydra() -> None:
    """Make Hydra see the options of plugins, and report option files that clash."""
    from placecue.components.boundary_options import BoundaryOptions  # made of what stands above
    from placecue.components.part_options import PartOptions  # made of what stands above

    plugins = HydraPlugins.instance()
    plugins.register(PluginOptions)
    plugins.register(ComponentOptions)
    plugins.register(PartOptions)
    plugins.register(BoundaryOptions)
    for clash in clashes():
        log.warning(clash)


def clashes() -> list[str]:
    """Describe the option files that stand under one name in more than one config path."""
    owner: dict[str, str] = {}
    found = []
    paths = {BUILT_IN_CONFIGS: "placecue", **current_plugins().config_paths}
    for path, distribution in paths.items():
        for option in option_files(path):
            if option in owner:
                found.append(
                    f"option file {option} of {distribution} ({path}) is left out: {owner[option]} "
                    "already has one of that name; rename it"
                )
            owner.setdefault(option, distribution)
    return found


def option_files(path: str) -> list[str]:
    """Return the YAML files under a ``pkg://`` config path, relative to it."""
    if not path.startswith("pkg://"):
        return []
    try:
        root = root_of(path)
    except (ModuleNotFoundError, TypeError):
        log.warning(f"config path {path} does not exist; a plugin names it")
        return []
    return sorted(_yaml_files(root, ""))


def root_of(path: str) -> Traversable:
    """Return the folder that a ``pkg://`` config path names."""
    return files(path.removeprefix("pkg://").replace("/", "."))


def _yaml_files(folder: Traversable, prefix: str) -> list[str]:
    found: list[str] = []
    for entry in folder.iterdir():
        if entry.is_dir():
            found += _yaml_files(entry, f"{prefix}{entry.name}/")
        elif entry.name.endswith(".yaml"):
            found.append(prefix + entry.name)
    return found
