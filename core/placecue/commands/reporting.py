"""``report.html`` of a command: whether it is wanted, and that it costs no results."""

from __future__ import annotations

import logging
import shlex
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from placecue.checks import check_flag
from placecue.errors import FOREIGN, PlacecueError, told
from placecue.evaluation.report.page import REPORT, Page
from placecue.evaluation.report.table import Facts

log = logging.getLogger(__name__)


def is_wanted(config: Mapping[str, Any]) -> bool:
    """Tell whether a config asks for a report.

    Raises
    ------
    UsageError
        If ``report`` is neither true nor false.
    """
    wanted: bool = config.get("report", True)
    check_flag("report", wanted)
    return wanted


def write(config: Mapping[str, Any], folder: Path, make: Callable[[], Page]) -> None:
    """Write the report of a command, where one is wanted.

    One that fails is told in a line, as the results are there all the same.

    Parameters
    ----------
    config : mapping
        Of the command.
    folder : Path
        Where to.
    make : callable
        Gives the page.
    """
    if not is_wanted(config):
        return
    try:
        (folder / REPORT).unlink(missing_ok=True)
        make().write(folder)
    except FOREIGN as error:
        reason = str(error) if isinstance(error, PlacecueError) else told(error)
        log.warning(f"{folder / REPORT} was not written, all else was: {reason}")


def written(config: Mapping[str, Any], folder: Path) -> list[tuple[str, Path]]:
    """Return the report of a folder with a word on it; nothing where there is none."""
    there = is_wanted(config) and (folder / REPORT).is_file()
    return [("report", folder / REPORT)] if there else []


def facts(config: Mapping[str, Any], log_name: str) -> Facts:
    """Return what a model was run on, as a report tells it."""
    versions = {name: version(name) for name in ("placecue", "numpy", "scikit-learn")}
    return Facts([
        ("Command", command_line()),
        ("Log", log_name),
        ("Model", str(config["model"])),
        ("Versions", ", ".join(f"{name} {each}" for name, each in versions.items())),
    ])  # fmt: skip


def command_line() -> str:
    """Return what was typed, as far as it is known."""
    from hydra.core.hydra_config import HydraConfig

    if not HydraConfig.initialized():
        return ""
    running = HydraConfig.get()
    own = [
        f"--config-dir={each.path}"
        for each in running.runtime.config_sources
        if each.provider == "command-line"
    ]
    return shlex.join(["placecue", str(running.job.name), *own, *running.overrides.task])
