"""Enters Hydra for one run, whose config is composed once.

``hydra.main`` composes a config twice: to look for ``hydra.mode`` in it, and to run. That is most
of what a command takes to start.
"""

from __future__ import annotations

from typing import Any

from hydra import version
from hydra._internal.hydra import Hydra
from hydra._internal.utils import create_config_search_path, get_args_parser
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.types import RunMode, TaskFunction
from omegaconf import DictConfig

#: The version of Hydra whose behaviour is kept to.
VERSION_BASE = "1.3"


class _Sweeps(Exception):
    """The config says that it is one of several runs."""


class _Once(Hydra):
    _looked = False

    def compose_config(self, *words: Any, **options: Any) -> DictConfig:
        """Compose a config; the first is that of the run, whose mode is looked at at once."""
        config = super().compose_config(*words, **options)
        if not self._looked and config.hydra.mode is RunMode.MULTIRUN:
            raise _Sweeps
        self._looked = True
        return config


def run_once(task: TaskFunction, name: str, configs: str, words: list[str]) -> bool:
    """Run a task with its config, where overrides are all that is asked for.

    Parameters
    ----------
    task : callable
        Called with the config.
    name : str
        The primary config.
    configs : str
        Where it lies.
    words : list of str
        What stands on the command line.

    Returns
    -------
    bool
        False where Hydra's own entry is needed, and nothing was done: there are options, or
        several values, or the config asks for a sweep.
    """
    asked = vars(get_args_parser().parse_args(words))
    overrides = asked.pop("overrides")
    parsed = OverridesParser.create().parse_overrides(overrides)
    if any(asked.values()) or any(each.is_sweep_override() for each in parsed):
        return False
    version.setbase(VERSION_BASE)
    path = create_config_search_path(configs)
    try:
        _Once.create_main_hydra2(name, path).run(name, task, overrides)
    except _Sweeps:
        return False
    finally:
        GlobalHydra.instance().clear()
    return True
