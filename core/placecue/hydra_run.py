"""Runs one command through Hydra: compose the config, call the command, turn errors into ours."""

from __future__ import annotations

import logging
import os
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.errors import HydraException
from hydra.types import RunMode
from omegaconf import DictConfig
from omegaconf.errors import MissingMandatoryValue, OmegaConfBaseException

from placecue.config import plain
from placecue.discovery.options import BUILT_IN_CONFIGS, register_with_hydra
from placecue.errors import PlacecueError, UsageError


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
    sys.argv = ["placecue", *overrides]
    entry = hydra.main(version_base="1.3", config_path=BUILT_IN_CONFIGS, config_name=command)
    try:
        entry(Task(command))()
    except SystemExit as done:
        # argparse's way out: --help, or an option that Hydra does not have.
        return done.code if isinstance(done.code, int) else 0
    except MissingMandatoryValue as error:
        raise UsageError(_missing(command, error)) from error
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
    """

    def __init__(self, command: str) -> None:
        self.command = command

    @property
    def __name__(self) -> str:
        return self.command

    def __call__(self, config: DictConfig) -> None:
        """Run the command."""
        module = import_module(f"placecue.commands.{self.command}")
        settings: dict[str, Any] = plain(config)
        if HydraConfig.get().mode is RunMode.MULTIRUN and module.OUT_IS_FOLDER:
            settings["out"] = str(Path(settings["out"]) / str(HydraConfig.get().job.num))
        module.run(settings)


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
