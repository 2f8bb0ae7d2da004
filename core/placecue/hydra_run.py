"""Runs one command through Hydra: compose the config, call the command, turn errors into ours."""

from __future__ import annotations

import io
import logging
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, redirect_stderr
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any, cast

import hydra
from hydra._internal.utils import get_args_parser
from hydra.conf import JobConf
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import ConfigCompositionException, HydraException, MissingConfigException
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import (
    InterpolationToMissingValueError,
    MissingMandatoryValue,
    OmegaConfBaseException,
)

from placecue.commands.names import TRACEBACK
from placecue.components.build import plain
from placecue.components.hooks import Kind
from placecue.components.manager import current_plugins
from placecue.components.options import BUILT_IN_CONFIGS, register_with_hydra
from placecue.components.searches import check_opened, opened
from placecue.composed_once import VERSION_BASE, run_once
from placecue.errors import PlacecueError, UsageError, choices, told
from placecue.limits import limited
from placecue.words import as_typed

#: How folders that sweeps have for themselves begin.
SWEEPS = ".placecue_sweep_"


def run_command(command: str, overrides: list[str]) -> int:
    """Run a command with Hydra's overrides and options.

    Parameters
    ----------
    command : str
        One of :data:`placecue.commands.names.COMMANDS`; its primary config has the same name.
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
    _log_to_stderr(["placecue"])
    logging.getLogger("placecue").setLevel(logging.INFO)
    overrides = _overrides_first(overrides)
    if "-sc" not in overrides:
        overrides = [as_typed(word) for word in overrides]
    _check_words(command, overrides)
    register_with_hydra()
    _log_to_stderr(_packages())
    # Hydra would print exceptions itself and exit; ours go up to the command line instead.
    os.environ["HYDRA_FULL_ERROR"] = "1"
    sys.argv = ["placecue", *(overrides if "-sc" in overrides else opened(_listed(overrides)))]
    try:
        with _sweep_folder(overrides) as given:
            sys.argv[1:1] = given  # before options, as Hydra wants overrides
            return _enter(Task(command, overrides), given)
    except (PlacecueError, BrokenPipeError):
        raise
    except Exception as error:
        known = _in_one_line(command, overrides, error)
        if known is None:
            raise
        raise known from error


def _listed(words: list[str]) -> list[str]:
    """Put brackets around several worlds, which without a sweep are worlds of one experiment."""
    if {"-m", "--multirun"}.intersection(words):
        return words
    return [re.sub(r"^(world\.\w+)=([^\[\]{}\"']*,[^\[\]{}\"']*)$", r"\1=[\2]", w) for w in words]


@contextmanager
def _sweep_folder(words: list[str]) -> Iterator[list[str]]:
    """Give Hydra a folder for what a sweep leaves besides results, and remove it afterwards.

    It lies in the working folder where jobs may run on other machines, which see that one only.
    """
    if not {"-m", "--multirun"}.intersection(words) or any("hydra.sweep." in w for w in words):
        yield []
        return
    elsewhere = any(word.startswith("hydra/launcher=submitit") for word in words)
    place = Path.cwd() if elsewhere else None
    with TemporaryDirectory(prefix=SWEEPS, dir=place, ignore_cleanup_errors=True) as at:
        # The time is looked up once and handed to all jobs, whose out= may be made of it.
        yield [f"hydra.sweep.dir='{at}/${{now:%Y-%m-%d_%H-%M-%S}}'"]


def _enter(task: Task, given: list[str]) -> int:
    try:
        if not run_once(task, task.command, BUILT_IN_CONFIGS, sys.argv[1:]):
            entry = hydra.main(BUILT_IN_CONFIGS, task.command, VERSION_BASE)
            entry(task)()
    except SystemExit as done:
        if task.error is None:
            return done.code if isinstance(done.code, int) else 0  # --help and the like
        raise task.error from task.error.__cause__
    for word in given:  # the folder of a sweep, while it is there
        from placecue.commands.sweeps import show

        show(Path(word.partition("=")[2].strip("'")).parent)
    task.report()
    return 0


class Task:
    """The function that Hydra calls with the composed config, once or once a sweep's job.

    Parameters
    ----------
    command : str
        The command.
    words : list of str
        What stands after it on the command line.

    Attributes
    ----------
    error : Exception or None
        What went wrong in a single run.
    failed : dict of str to Exception
        What went wrong in the jobs of a sweep, by what is special about them.
    jobs : int
        How many jobs of a sweep were run.
    """

    def __init__(self, command: str, words: list[str]) -> None:
        self.command = command
        self.words = words
        self.error: Exception | None = None
        self.failed: dict[str, Exception] = {}
        self.jobs = 0
        self._process = os.getpid()

    @property
    def __name__(self) -> str:
        return self.command

    def __call__(self, config: DictConfig) -> None:
        """Run the command."""
        hydra_config = HydraConfig.get()
        if hydra_config.mode is RunMode.MULTIRUN:
            self._run_job(config, hydra_config.job)
            return
        try:
            self._run(config)
        except Exception as error:
            # Hydra writes a line of its own about exceptions, but lets an exit pass.
            self.error = error
            raise SystemExit(1) from error

    def _run_job(self, config: DictConfig, job: JobConf) -> None:
        self.jobs += 1
        try:
            self._run(config, job.num)
        except Exception as error:
            if os.getpid() != self._process:
                raise  # a launcher runs jobs elsewhere: Hydra brings this back
            self.failed[f"job {job.num} ({job.override_dirname})"] = error

    def _run(self, config: DictConfig, job: int | None = None) -> None:
        from placecue.commands.outputs import guarded

        check_opened(config, HydraConfig.get().overrides.task)
        module = import_module(f"placecue.commands.{self.command}")
        settings: dict[str, Any] = plain(config)
        if job is not None and settings.get("out") is not None:
            settings["out"] = self._out_of_job(config, settings, job, module.WRITES is not None)
        resumes = getattr(module, "RESUMES", None)
        with limited(settings.get("limits")), guarded(settings, module.WRITES, resumes=resumes):
            try:
                scores = self._told_of(settings, module.run)
            except SystemExit as error:
                if isinstance(error.__context__, BrokenPipeError):  # how rich says it
                    raise error.__context__ from None
                raise PlacecueError(
                    f"{self.command} broke off: something called sys.exit({error.code!r}) in the "
                    f"middle of it; {TRACEBACK}=1 before the command shows where"
                ) from error

        if job is not None and scores:
            self._keep(job, scores)

    def _keep(self, job: int, scores: Mapping[str, float]) -> None:
        """Leave the scores of a job in the sweep's folder, if it has one of ours."""
        from placecue.commands.numbered import swept_keys
        from placecue.commands.sweeps import keep

        running = HydraConfig.get()
        if Path(running.sweep.dir).parent.name.startswith(SWEEPS):
            typed = get_args_parser().parse_args(self.words).overrides
            swept = swept_keys(typed, running.sweeper.get("params") or {})
            keep(Path(running.sweep.dir), job, list(running.overrides.task), swept, scores)

    def _told_of(
        self, settings: dict[str, Any], run: Callable[[dict[str, Any]], Mapping[str, float] | None]
    ) -> Mapping[str, float] | None:
        """Run the command, and tell plugins of its beginning, and of a bad end."""
        from placecue.commands.paths import path_of

        plugins = current_plugins()
        out = None if settings.get("out") is None else path_of(settings, "out")
        plugins.tell("run_started", command=self.command, config=settings, out=out)
        try:
            return run(settings)
        except BaseException as error:
            plugins.tell("run_failed", command=self.command, reason=told(error))
            raise

    def _out_of_job(
        self, config: DictConfig, settings: dict[str, Any], job: int, is_folder: bool
    ) -> str:
        """Return where a job of a sweep writes."""
        from placecue.commands.numbered import of_job, swept_keys, tells_jobs_apart
        from placecue.commands.paths import path_of

        out = path_of(settings, "out")
        overrides = get_args_parser().parse_args(self.words).overrides
        swept = swept_keys(overrides, HydraConfig.get().sweeper.get("params") or {})
        named = not is_folder and tells_jobs_apart(config, swept)
        return str(out if named else of_job(out, job, is_folder))

    def report(self) -> None:
        """Raise one error over the jobs of a sweep that failed; the others have run."""
        if not self.failed:
            return
        known = {
            job: _in_one_line(self.command, [], error) or error
            for job, error in self.failed.items()
        }
        first = next(iter(known.values()))
        kind = type(first) if isinstance(first, PlacecueError) else PlacecueError
        told = "; ".join(f"{job}: {error}" for job, error in known.items())
        cause = next(iter(self.failed.values()))
        raise kind(f"{len(known)} of {self.jobs} jobs failed: {told}") from cause


def _check_words(command: str, words: list[str]) -> None:
    """Refuse what Hydra cannot parse, in one line that names it.

    Raises
    ------
    UsageError
        If an option is unknown, or an override malformed.
    """
    said = io.StringIO()
    try:
        with redirect_stderr(said):
            overrides = get_args_parser().parse_args(words).overrides
    except SystemExit as error:
        reason = said.getvalue().strip().rpartition("error: ")[2]
        raise UsageError(f"{command}: {reason}; see placecue {command} --hydra-help") from error
    if "-sc" in words:
        return  # unfinished words are what completion is for
    parser = OverridesParser.create()
    for override in overrides:
        try:
            key = parser.parse_override(override).key_or_group
        except HydraException as error:
            raise UsageError(
                f"{command}: cannot read '{override}' ({_one_line(error)}): give key=value, and "
                f"put a value with special characters in quotes: 'key=\"value\"'"
            ) from error
        if not key:
            raise UsageError(f"{command}: '{override}' has no key: give key=value")


def _overrides_first(words: list[str]) -> list[str]:
    """Put overrides before options: Hydra refuses those that come after one."""
    if "-sc" in words:
        return words
    return sorted(words, key=lambda word: re.match(r"[^-=][^=]*=|~", word) is None)


def _log_to_stderr(packages: Iterable[str]) -> None:
    """Show what packages have to say, a line each."""
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("placecue: %(message)s"))
    for name in packages:
        logging.getLogger(name).handlers = [handler]
        logging.getLogger(name).propagate = False


def _packages() -> set[str]:
    """Return the top-level packages of all plugins that loaded."""
    plugins = current_plugins().manager.get_plugins()
    modules = (p.__name__ if isinstance(p, ModuleType) else type(p).__module__ for p in plugins)
    return {module.partition(".")[0] for module in modules}


def _in_one_line(command: str, overrides: list[str], error: Exception) -> PlacecueError | None:
    """Put an error of Hydra or of the system into our words; None where it is neither."""
    if isinstance(error, (MissingMandatoryValue, InterpolationToMissingValueError)):
        return UsageError(_missing(command, error))
    if isinstance(error, MissingConfigException):
        return UsageError(_unknown_option(command, error))
    if isinstance(error, ConfigCompositionException):
        return UsageError(_unknown_key(command, overrides, error))
    of_hydra = isinstance(error, ValueError) and _raised_by_hydra(error)
    if of_hydra or isinstance(error, (HydraException, OmegaConfBaseException)):
        return UsageError(f"{command}: {_one_line(error)}")
    if isinstance(error, OSError):
        where = f" {error.filename}" if error.filename else ""
        return PlacecueError(f"{command}: {error.strerror or error}{where}")
    return None


def _missing(command: str, error: Exception) -> str:
    # Where another key stands for the missing one, the message alone names the one to give.
    found = re.search(r"Missing mandatory value: ([\w.]+)", str(error))
    whole = getattr(error, "full_key", None) if isinstance(error, MissingMandatoryValue) else None
    key = whole or (found[1] if found else "a value")
    return f"{command} needs {key}=...; see placecue {command} --help"


def _unknown_option(command: str, error: MissingConfigException) -> str:
    group, _, name = str(error.missing_cfg_file).rpartition("/")
    kind = {"part": "cue", "parts": "cue", "boundaries": "boundary"}.get(group, group)
    options = error.options or current_plugins().registry.names(cast(Kind, kind))
    if not group:
        return f"{command}: {_one_line(error)}"
    return f"{command}: unknown {kind} '{name}'; {choices(name, options)}"


def _unknown_key(command: str, overrides: list[str], error: Exception) -> str:
    """Describe an override of a key that is not there, with the keys that are."""
    found = re.match(r"Could not override '([^']+)'", str(error))
    if found is None:
        return f"{command}: {_one_line(error)}"
    key = found.group(1).rpartition("@")[2]
    parent, _, name = key.rpartition(".")
    known = _node(command, [o for o in overrides if not o.startswith((key, "-"))], parent)
    if name in known:  # the value was refused, not the key
        return f"{command}: {_one_line(error)}"
    where = f" in {parent}" if parent else ""
    start = f"{parent}." if parent else ""
    inside = [f"{start}{place}" for place in _places_of(name, known)]
    if inside:
        return f"{command}: there is no '{name}'{where}; did you mean {' or '.join(inside)}?"
    return f"{command}: there is no '{name}'{where}; {choices(name, map(str, known))}"


def _places_of(name: str, node: DictConfig) -> list[str]:
    """Return where a key stands in the components inside one."""
    items = ((str(key), each) for key, each in node.items_ex(resolve=False))
    inner = {key: each for key, each in items if isinstance(each, DictConfig) and "plugin" in each}
    found = [f"{key}.{name}" for key, each in inner.items() if name in each]
    return found + [f"{key}.{at}" for key, each in inner.items() for at in _places_of(name, each)]


def _node(command: str, overrides: list[str], parent: str) -> DictConfig:
    """Return what stands at a place in the config of a command; empty where nothing does."""
    with hydra.initialize_config_module(
        version_base=VERSION_BASE, config_module=BUILT_IN_CONFIGS.removeprefix("pkg://")
    ):
        try:
            config = hydra.compose(command, overrides)
        except HydraException:
            return OmegaConf.create({})
    node = OmegaConf.select(config, parent) if parent else config
    return node if isinstance(node, DictConfig) else OmegaConf.create({})


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
