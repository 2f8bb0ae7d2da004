"""Loads plugins, one entry point at a time.

pluggy's own loader stops at the first broken plugin and passes over a repeated name in silence;
here a broken plugin is listed with its error and does not stop the rest.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint
from typing import Any

import pluggy

from placecue.compiled import arrange
from placecue.components import hooks
from placecue.components.registry import Problem, Registry
from placecue.distributions import installed_entry_points
from placecue.errors import FOREIGN, PluginError, UsageError, told

GROUP = "placecue"
BUILT_IN = "placecue"
#: Set to 1 to run the built-ins alone; ``--no-plugins`` sets it.
NO_PLUGINS = "PLACECUE_NO_PLUGINS"


@dataclass(frozen=True)
class Plugins:
    """What was loaded.

    Parameters
    ----------
    manager : pluggy.PluginManager
        Calls run events on the plugins.
    registry : Registry
        The components they brought.
    config_paths : dict of str to str
        Config paths that plugins brought, each with its distribution.
    """

    manager: pluggy.PluginManager
    registry: Registry
    config_paths: dict[str, str]

    def tell(self, event: str, **details: Any) -> None:
        """Tell every plugin of a run event, such as ``log_opened``.

        Raises
        ------
        PluginError
            If a plugin fails on it; the cause is chained.
        UsageError
            If a plugin refuses what was asked for.
        """
        for listener in getattr(self.manager.hook, f"placecue_{event}").get_hookimpls():
            try:
                listener.function(**{name: details[name] for name in listener.argnames})
            except UsageError:  # what a plugin refuses in words of its own
                raise
            except FOREIGN as error:
                raise PluginError(
                    f"plugin {listener.plugin_name} failed on {event}: {told(error)}"
                ) from error


def load_plugins(
    found: Iterable[EntryPoint] | None = None, *, built_ins_only: bool = False
) -> Plugins:
    """Load every installed plugin.

    Parameters
    ----------
    found : iterable of EntryPoint, optional
        What to load; by default the entry points of the group ``placecue``.
    built_ins_only : bool
        Leave out what is not of placecue's own distribution.

    Returns
    -------
    Plugins
        Broken plugins are in ``registry.problems``.
    """
    arrange()
    manager = pluggy.PluginManager(hooks.PROJECT)
    manager.add_hookspecs(hooks)
    loaded = Plugins(manager, Registry(), {})
    if found is None:
        found, broken = installed_entry_points(GROUP)
        loaded.registry.problems += [Problem(each.where, "", "", each.error) for each in broken]
    for entry_point in sorted(found, key=_order):
        distribution, version = _origin(entry_point)
        if built_ins_only and distribution != BUILT_IN:
            continue
        error = _load(entry_point, distribution, version, loaded)
        if error:
            problem = Problem(f"{distribution}:{entry_point.name}", distribution, version, error)
            loaded.registry.problems.append(problem)
    return loaded


@cache
def current_plugins() -> Plugins:
    """Return the installed plugins, loaded once a process."""
    return load_plugins(built_ins_only=os.environ.get(NO_PLUGINS) == "1")


def _origin(entry_point: EntryPoint) -> tuple[str, str]:
    distribution = entry_point.dist
    return ("unknown", "") if distribution is None else (distribution.name, distribution.version)


def _order(entry_point: EntryPoint) -> tuple[bool, str, str]:
    name = _origin(entry_point)[0]
    return name != BUILT_IN, name, entry_point.name


def _load(entry_point: EntryPoint, distribution: str, version: str, loaded: Plugins) -> str | None:
    """Load one plugin; return what was wrong with it, or None."""
    name = f"{distribution}:{entry_point.name}"
    try:
        loaded.manager.register(entry_point.load(), name=name)
        loaded.manager.check_pending()
        paths = _contributions(loaded, name, "placecue_config_paths")
        components = _contributions(loaded, name, "placecue_components")
        loaded.registry.add(components, distribution, version)
        loaded.config_paths.update({str(path): distribution for path in paths})
    # A plugin may do anything while it is imported, such as sys.exit; only ^C goes through.
    except (Exception, SystemExit) as error:
        if loaded.manager.has_plugin(name):
            loaded.manager.unregister(name=name)
        return f"{type(error).__name__}: {' '.join(str(error).split())}"
    return None


def _contributions(loaded: Plugins, name: str, hook: str) -> list[Any]:
    implementations: list[Callable[[], Iterable[Any]]] = [
        each.function
        for each in getattr(loaded.manager.hook, hook).get_hookimpls()
        if each.plugin_name == name
    ]
    return [item for function in implementations for item in function()]
