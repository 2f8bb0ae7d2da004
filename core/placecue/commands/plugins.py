"""``placecue plugins``: what is installed, and what does not load."""

from __future__ import annotations

import sys
from dataclasses import asdict
from functools import partial
from typing import Any

from placecue.commands import as_json
from placecue.components.manager import current_plugins
from placecue.components.registry import Registry
from placecue.errors import PluginError, UsageError, choices

WRITES = None
HEADINGS = ("kind", "name", "summary", "distribution", "version", "status")


def run(config: dict[str, Any]) -> None:
    """Print a table of components with kind, name, summary, distribution, version and status.

    Raises
    ------
    PluginError
        After the table, if a plugin does not load or two claim one name.
    """
    registry = current_plugins().registry
    wanted = config.get("kind")
    rows = [row for row in table(registry) if wanted is None or row[0] == wanted]
    if wanted is not None and not rows:
        raise UsageError(f"no component of kind '{wanted}'; {choices(wanted, _kinds(registry))}")
    if as_json.wanted(config):
        as_json.tell({
            "components": [dict(zip(HEADINGS, row, strict=True)) for row in rows],
            "problems": [asdict(each) for each in registry.problems],
        })  # fmt: skip
    else:
        _print(rows)
    problems = [f"{each.plugin} {each.version}: {each.error}" for each in registry.problems]
    conflicts = {registry.conflict(each.component.kind, each.component.name) for each in registry}
    told = partial(print, file=sys.stderr if as_json.wanted(config) else sys.stdout)
    for problem in problems:
        told(f"does not load: {problem}")
    for conflict in sorted(conflicts - {None}, key=str):
        told(f"conflict: {conflict}")
    if problems or conflicts != {None}:
        raise PluginError(
            f"{len(problems)} plugins do not load, {len(conflicts - {None})} names are in conflict"
        )


def table(registry: Registry) -> list[tuple[str, ...]]:
    """Return one row a component: kind, name, summary, distribution, version, status."""
    return [
        (
            each.component.kind,
            each.component.name,
            each.component.summary,
            each.distribution,
            each.version,
            "conflict" if registry.conflict(each.component.kind, each.component.name) else "ok",
        )
        for each in registry
    ]


def _kinds(registry: Registry) -> set[str]:
    return {each.component.kind for each in registry}


def _print(rows: list[tuple[str, ...]]) -> None:
    from rich.console import Console
    from rich.table import Table

    shown = Table(box=None, header_style="bold", pad_edge=False)
    for heading in HEADINGS:
        shown.add_column(heading, overflow="fold")
    for row in rows:
        shown.add_row(*row)
    Console(width=None if Console().is_terminal else 160).print(shown)
