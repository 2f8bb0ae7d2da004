"""What a component is and who brought it, for messages."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from importlib.metadata import (
    Distribution,
    PackageNotFoundError,
    distribution,
    packages_distributions,
)
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

from placecue.distributions import installed_entry_points

#: What the interfaces are called, by where they are.
INTERFACES = {
    "placecue.cue.Cue": "cue",
    "placecue.kernel.Kernel": "kernel",
    "placecue.classifier.Classifier": "classifier",
    "placecue.integrator.Integrator": "integrator",
    "placecue.accumulator.Accumulator": "accumulator",
    "placecue.accumulator.Boundary": "boundary",
    "placecue.source.Source": "source",
    "placecue.folds.FoldScheme": "folds",
    "placecue.scaling.Scaling": "scaling",
    "placecue.scores.Layout": "layout",
    "placecue.logs.adapters.base.Adapter": "adapter",
}


@dataclass(frozen=True, slots=True)
class Provenance:
    """What a component is and who brought it.

    Parameters
    ----------
    kind : str
        Such as ``cue``.
    name : str
        What a config calls it, in quotes; its class where it was not loaded by name.
    distribution, version : str
        What was installed to get it; a module and nothing where that is not known.
    """

    kind: str
    name: str
    distribution: str
    version: str = ""

    def __str__(self) -> str:
        owner = f"{self.distribution} {self.version}".rstrip()
        return f"{self.kind} {self.name} ({owner})"


_REMEMBERED: WeakKeyDictionary[type, Provenance] = WeakKeyDictionary()


def remember(factory: Any, kind: str, name: str, distribution: str, version: str) -> None:
    """Keep what the class of a component was registered as; anything but a class is passed over."""
    if isinstance(factory, type):
        _REMEMBERED[factory] = Provenance(kind, f"'{name}'", distribution, version)


def provenance(component: object) -> Provenance:
    """Return what a component is and who brought it, as far as that can be known.

    Slow where the component was not loaded by name: meant for messages.
    """
    of_type = type(component)
    known = _REMEMBERED.get(of_type)
    if known is not None:
        return known
    owner = _owner(of_type.__module__)
    where = (of_type.__module__, "") if owner is None else (owner.name, owner.version)
    return Provenance(kind_of_class(of_type) or "component", of_type.__qualname__, *where)


def kind_of_class(cls: Any) -> str | None:
    """Return the kind of a class by the interface that it is derived from; else None."""
    bases = (f"{base.__module__}.{base.__qualname__}" for base in getattr(cls, "__mro__", ()))
    return next((INTERFACES[base] for base in bases if base in INTERFACES), None)


@cache
def _owner(module: str) -> Distribution | None:
    """Return the distribution of a module, or None."""
    package = module.partition(".")[0]
    # An editable install lists no packages, but its entry points name them.
    for plugin in installed_entry_points("placecue")[0]:
        if plugin.module.partition(".")[0] == package and plugin.dist is not None:
            return plugin.dist
    for name in _distributions_of(package):
        try:
            found = distribution(name)
        except (PackageNotFoundError, ValueError):
            continue
        if _holds(found, module):
            return found
    return None


def _distributions_of(package: str) -> list[str]:
    try:
        return packages_distributions().get(package, [package])
    except Exception:  # one broken record of anybody's is enough
        return [package]


def _holds(found: Distribution, module: str) -> bool:
    """Tell whether a module lies where a distribution with a package so called does.

    Some distributions bring their ``tests`` along.
    """
    file = getattr(sys.modules.get(module), "__file__", None)
    root = Path(str(found.locate_file("")))
    return file is not None and Path(file).is_relative_to(root)
