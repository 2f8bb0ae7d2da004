"""Versions, plugins and optional parts."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from platform import platform, python_version

import placecue
from placecue.commands.checkup.finding import Finding
from placecue.components.registry import Registry

#: Name, sign and number at the beginning of a requirement, and the extra at its end.
REQUIREMENT = re.compile(
    r"(?P<name>[\w.-]+)(?:\[[^\]]*\])?(?P<bounds>[^;]*)(?:;.*extra == ['\"](?P<extra>[\w-]+)['\"])?"
)


def installation(registry: Registry) -> Iterator[Finding]:
    """Look at what is installed."""
    where = Path(placecue.__file__).parent
    yield Finding("ok", "placecue", f"{placecue.__version__} in {where}")
    yield Finding("ok", "python", f"{python_version()} at {sys.executable}, {platform()}")
    yield from _distributions()
    yield from _plugins(registry)


def _distributions() -> Iterator[Finding]:
    """Look at each requirement: what placecue needs, then its extras."""
    found: list[str] = []
    extras: dict[str, list[tuple[str, str | None]]] = {}
    try:
        needed = requires("placecue") or []
    except PackageNotFoundError:
        mend = "install it: pip install placecue"
        yield Finding("wrong", "distribution", "placecue is imported but not installed", mend)
        return
    for each in needed:
        match = REQUIREMENT.match(each)
        if match is None:
            continue
        name, there = match["name"], _version(match["name"])
        if match["extra"]:
            extras.setdefault(match["extra"], []).append((name, there))
        elif there is None:
            yield Finding("wrong", name, "is not installed", f"pip install '{each}'")
        else:
            found.append(f"{name} {there}")
    yield Finding("ok", "libraries", ", ".join(sorted(found, key=str.lower)))
    for extra, parts in extras.items():
        lacking = [name for name, there in parts if there is None]
        if lacking:
            mend = f"pip install 'placecue[{extra}]' if you want it"
            yield Finding("note", f"extra {extra}", f"without {', '.join(lacking)}", mend)
        else:
            told = ", ".join(f"{name} {there}" for name, there in parts)
            yield Finding("ok", f"extra {extra}", told)


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
    except Exception:  # the records of others may be broken in any way
        return None


def _plugins(registry: Registry) -> Iterator[Finding]:
    brought: dict[str, int] = {}
    for each in registry:
        brought[f"{each.distribution} {each.version}"] = (
            brought.get(f"{each.distribution} {each.version}", 0) + 1
        )
    told = ", ".join(f"{count} components of {name}" for name, count in brought.items())
    yield Finding("ok", "plugins", told)
    for problem in registry.problems:
        name = f"{problem.plugin} {problem.version}".strip()
        mend = "reinstall or uninstall it, or run with --no-plugins"
        yield Finding("wrong", f"plugin {name}", f"does not load: {problem.error}", mend)
    conflicts = {registry.conflict(each.component.kind, each.component.name) for each in registry}
    for conflict in sorted(each for each in conflicts if each):
        yield Finding("wrong", "names", conflict)
