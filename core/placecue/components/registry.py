"""What is installed: every component by kind and name, and who brought it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from placecue.components.hooks import KINDS, Component, Kind
from placecue.errors import FOREIGN, PluginError, UsageError, choices, told
from placecue.ownership import remember


@dataclass(frozen=True, slots=True)
class Provided:
    """A component and the distribution that brought it."""

    component: Component
    distribution: str
    version: str


@dataclass(frozen=True, slots=True)
class Problem:
    """A plugin that could not be used, in part or at all.

    Parameters
    ----------
    plugin : str
        Its entry point.
    distribution, version : str
        Where it came from.
    error : str
        What was wrong, in one line.
    """

    plugin: str
    distribution: str
    version: str
    error: str


class Registry:
    """All components that plugins brought."""

    def __init__(self) -> None:
        self._claims: dict[tuple[Kind, str], list[Provided]] = defaultdict(list)
        self.problems: list[Problem] = []

    def add(self, components: Sequence[Component], distribution: str, version: str) -> None:
        """Register the components of one plugin, all or none of them.

        Raises
        ------
        PluginError
            If one is of an unknown kind or its factory is no import string.
        """
        for component in components:
            self._check(component)
        for component in components:
            claim = Provided(component, distribution, version)
            self._claims[component.kind, component.name].append(claim)

    @staticmethod
    def _check(component: Component) -> None:
        if component.kind not in KINDS:
            raise PluginError(
                f"component '{component.name}' is of unknown kind '{component.kind}'; "
                f"{choices(component.kind, KINDS)}"
            )
        if component.factory.count(":") != 1:
            raise PluginError(
                f"the factory of {component.kind} '{component.name}' is '{component.factory}'; "
                "it must be an import string such as 'package.module:Class'"
            )

    def __iter__(self) -> Iterator[Provided]:
        """Iterate over every claim, by kind and name."""
        order = sorted(self._claims, key=lambda key: (KINDS.index(key[0]), key[1]))
        return (claim for key in order for claim in self._claims[key])

    def names(self, kind: Kind) -> list[str]:
        """Return the names of one kind, sorted."""
        return sorted(name for of_kind, name in self._claims if of_kind == kind)

    def kinds_of(self, name: str) -> list[Kind]:
        """Return the kinds under which a name is known."""
        return [kind for kind in KINDS if (kind, name) in self._claims]

    def conflict(self, kind: Kind, name: str) -> str | None:
        """Return a description of the conflict over a name, or None."""
        claims = self._claims.get((kind, name), [])
        if len(claims) < 2:
            return None
        owners = " and ".join(f"{c.distribution} {c.version}" for c in claims)
        return (
            f"{kind} '{name}' is claimed by {owners}: uninstall one of them, or run with "
            "--no-plugins to use the built-ins alone"
        )

    def get(self, kind: Kind, name: str) -> Provided:
        """Return the component of a name.

        Raises
        ------
        UsageError
            If there is none.
        PluginError
            If two plugins claim the name.
        """
        if (kind, name) not in self._claims:
            broken = "".join(f"; plugin {p.plugin} did not load: {p.error}" for p in self.problems)
            raise UsageError(f"unknown {kind} '{name}'; {choices(name, self.names(kind))}{broken}")
        conflict = self.conflict(kind, name)
        if conflict:
            raise PluginError(conflict)
        return self._claims[kind, name][0]

    def load(self, kind: Kind, name: str) -> Any:
        """Import and return the class of a component.

        Raises
        ------
        PluginError
            If its module cannot be imported; the cause is chained.
        """
        provided = self.get(kind, name)
        module, attribute = provided.component.factory.split(":")
        try:
            loaded = getattr(import_module(module), attribute)
        except FOREIGN as error:
            raise PluginError(
                f"{kind} '{name}' of {provided.distribution} {provided.version} cannot be "
                f"imported from {provided.component.factory}: {told(error)}"
            ) from error
        remember(loaded, kind, name, provided.distribution, provided.version)
        return loaded

    def find(self, component: object) -> Provided | None:
        """Return which registered component an instance is of, or None."""
        factory = f"{type(component).__module__}:{type(component).__qualname__}"
        package = factory.split(".")[0].split(":")[0]
        for claims in self._claims.values():
            for claim in claims:
                name = claim.component.factory
                if name == factory or (
                    # A factory may name a class where its package re-exports it.
                    name.split(":")[0].split(".")[0] == package
                    and name.split(":")[1] == type(component).__qualname__
                    and self.load(claim.component.kind, claim.component.name) is type(component)
                ):
                    return claim
        return None
