"""Runs one command through Hydra: compose the config, call the command, turn errors into ours."""

from __future__ import annotations

import logging
import os
import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Any, cast

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.errors import ConfigCompositionException, HydraException, MissingConfigException
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import MissingMandatoryValue, OmegaConfBaseException

from placecue.config import plain
from placecue.discovery.hooks import Kind
from placecue.discovery.manager import current_plugins
from placecue.discovery.options import BUILT_IN_CONFIGS, register_with_hydra
from placecue.errors import PlacecueError, UsageError, choices


def run_command(command: str, overrides: list[str]) -> int:
    """Run a command with Hydra's overrides and options.

    Parameters
    ----------
    command : str
        One of :data:`placecue.cli.COMMANDS`; its primary config has the same name.
    overrides : list of str
        What stands after it on the command line.

    Returns
    -------
    int
        The exit status.

    Raises
    ------
    PlacecueError
        If anything goes wrong on purpose.
    """
    _log_to_stderr()
    register_with_hydra()
    # Hydra would print exceptions itself and exit; ours go up to the command line instead.
    os.environ["HYDRA_FULL_ERROR"] = "1"
    sys.argv = ["placecue", *_overrides_first(overrides)]
    entry = hydra.main(version_base="1.3", config_path=BUILT_IN_CONFIGS, config_name=command)
    task = Task(command)
    try:
        entry(task)()
    except SystemExit as done:
        if task.error is not None:
            raise task.error from task.error.__cause__
        # argparse's way out: --help, or an option that Hydra does not have.
        return done.code if isinstance(done.code, int) else 0
    except MissingMandatoryValue as error:
        raise UsageError(_missing(command, error)) from error
    except MissingConfigException as error:
        raise UsageError(_unknown_option(command, error)) from error
    except ConfigCompositionException as error:
        raise UsageError(_unknown_key(command, overrides, error)) from error
    except (HydraException, OmegaConfBaseException) as error:
        raise UsageError(f"{command}: {_one_line(error)}") from error
    except ValueError as error:
        if error.__traceback__ is not None and _raised_by_hydra(error):
            raise UsageError(f"{command}: {_one_line(error)}") from error
        raise
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        raise PlacecueError(f"{command}: {error.strerror or error}{where}") from error
    return 0


class Task:
    """The function that Hydra calls with the composed config, once or once a sweep's job.

    Parameters
    ----------
    command : str
        The command.

    Attributes
    ----------
    error : Exception or None
        What went wrong in a single run.
    """

    def __init__(self, command: str) -> None:
        self.command = command
        self.error: Exception | None = None

    @property
    def __name__(self) -> str:
        return self.command

    def __call__(self, config: DictConfig) -> None:
        """Run the command."""
        if HydraConfig.get().mode is RunMode.MULTIRUN:
            self._run(config, HydraConfig.get().job.num)
            return
        try:
            self._run(config)
        except Exception as error:
            # Hydra writes a line of its own about exceptions, but lets an exit pass.
            self.error = error
            raise SystemExit(1) from error

    def _run(self, config: DictConfig, job: int | None = None) -> None:
        module = import_module(f"placecue.commands.{self.command}")
        settings: dict[str, Any] = plain(config)
        if job is not None and module.OUT_IS_FOLDER:
            settings["out"] = str(Path(settings["out"]) / str(job))
        module.run(settings)


def _overrides_first(words: list[str]) -> list[str]:
    """Put overrides before options: Hydra refuses those that come after one."""
    if "-sc" in words:
        return words
    return sorted(words, key=lambda word: re.match(r"[^-=][^=]*=|~", word) is None)


def _log_to_stderr() -> None:
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("placecue: %(message)s"))
    logger = logging.getLogger("placecue")
    for name in ("placecue", "placecue_cues", "placecue_sources", "placecue_accumulators"):
        logging.getLogger(name).handlers = [handler]
        logging.getLogger(name).propagate = False
    logger.setLevel(logging.INFO)


def _missing(command: str, error: MissingMandatoryValue) -> str:
    key = getattr(error, "full_key", None) or "a value"
    return f"{command} needs {key}=...; see placecue {command} --help"


def _unknown_option(command: str, error: MissingConfigException) -> str:
    group, _, name = str(error.missing_cfg_file).rpartition("/")
    options = error.options or current_plugins().registry.names(cast(Kind, group))
    if not group:
        return f"{command}: {_one_line(error)}"
    return f"{command}: unknown {group} '{name}'; {choices(name, options)}"


def _unknown_key(command: str, overrides: list[str], error: Exception) -> str:
    """Describe an override of a key that is not there, with the keys that are."""
    found = re.match(r"Could not override '([^']+)'", str(error))
    if found is None:
        return f"{command}: {_one_line(error)}"
    key = found.group(1)
    parent, _, name = key.rpartition(".")
    known = _keys_of(command, [o for o in overrides if not o.startswith((key, "-"))], parent)
    where = f" in {parent}" if parent else ""
    return f"{command}: there is no '{name}'{where}; {choices(name, known)}"


def _keys_of(command: str, overrides: list[str], parent: str) -> list[str]:
    with hydra.initialize_config_module(
        version_base="1.3", config_module=BUILT_IN_CONFIGS.removeprefix("pkg://")
    ):
        try:
            config = hydra.compose(command, overrides)
        except HydraException:
            return []
    node = OmegaConf.select(config, parent) if parent else config
    return [str(key) for key in node] if isinstance(node, DictConfig) else []


def _one_line(error: BaseException) -> str:
    text = str(error)
    cause = error.__cause__
    if isinstance(cause, OmegaConfBaseException) and str(cause) not in text:
        text = f"{text}: {cause}"
    return " ".join(text.split())


def _raised_by_hydra(error: BaseException) -> bool:
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    return frame is not None and frame.tb_frame.f_globals.get("__name__", "").startswith("hydra")
