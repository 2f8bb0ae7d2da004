"""``placecue doctor``: what is installed, what is wrong, how to mend it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from placecue.commands import as_json
from placecue.commands.checkup import given
from placecue.commands.checkup.finding import Finding
from placecue.commands.checkup.installation import installation
from placecue.commands.checkup.machine import machine
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.errors import DataError

WRITES = None


def run(config: dict[str, Any]) -> None:
    """Look at the installation, the machine, and the log and model that are given.

    Raises
    ------
    DataError
        At the end, if anything is wrong.
    """
    as_data = as_json.wanted(config)
    findings = []
    for finding in _looked_at(config):
        findings.append(finding)
        if not as_data:
            print(finding, flush=True)
    if as_data:
        as_json.tell([asdict(each) for each in findings])
    wrong = [each for each in findings if each.state == "wrong"]
    if wrong:
        things = "1 thing is" if len(wrong) == 1 else f"{len(wrong)} things are"
        raise DataError(f"{things} wrong, the first: {wrong[0].what}: {wrong[0].found}")


def _looked_at(config: dict[str, Any]) -> Iterator[Finding]:
    plugins = current_plugins()
    yield from installation(plugins.registry)
    yield from machine(config)
    if config["source"].get("path"):
        yield from given.logs(config, plugins)
    if config["model"] is not None:
        yield from given.model(path_of(config, "model"), plugins)
