"""What a plugin can bring. A plugin is a module with functions marked ``@hookimpl``.

It is named in the entry-point group ``placecue`` of its distribution::

    [project.entry-points.placecue]
    my_plugin = "my_package"

and the module says what it brings without importing anything heavy::

    from placecue import Component, hookimpl

    @hookimpl
    def placecue_components():
        return [Component("cue", "depth", "my_package.depth:Depth", "Histogram of depth")]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import pluggy

Kind = Literal[
    "cue",
    "kernel",
    "classifier",
    "integrator",
    "accumulator",
    "boundary",
    "source",
    "folds",
    "scaling",
    "layout",
    "adapter",
]
KINDS: tuple[Kind, ...] = get_args(Kind)
PROJECT = "placecue"

hookspec = pluggy.HookspecMarker(PROJECT)
hookimpl = pluggy.HookimplMarker(PROJECT)


@dataclass(frozen=True, slots=True)
class Component:
    """Something that a plugin brings and a config can name.

    Parameters
    ----------
    kind : str
        What it is: cue, kernel, classifier, integrator, accumulator, boundary, source, folds,
        scaling, layout or adapter.
    name : str
        What a config calls it: ``plugin: NAME``.
    factory : str
        Import string ``module:attribute`` of the class, imported when it is first built.
    summary : str
        What it does, in one line.
    requires : sequence of str
        What it needs: parts of an observation, or words for a person.
    recognise : str
        Of a source: import string of a function that takes a :class:`placecue.recognition.Found`
        and returns how sure it is that the source reads it (2 by what it holds, 1 by its name or
        shape, 0 not at all). Its module should import nothing heavy.
    """

    kind: Kind
    name: str
    factory: str
    summary: str = ""
    requires: Sequence[str] = ()
    recognise: str = ""


@hookspec
def placecue_components() -> Sequence[Component]:  # type: ignore[empty-body]
    """Return the components that the plugin brings."""


@hookspec
def placecue_config_paths() -> Sequence[str]:  # type: ignore[empty-body]
    """Return config paths such as ``pkg://my_package.conf`` that hold Hydra option files."""


@hookspec
def placecue_run_started(command: str, config: Any, out: Path | None) -> None:
    """Told when a command begins, with its config as plain data and where it will write.

    Nothing is written there yet, and nothing checked; what raises UsageError ends the command.
    """


@hookspec
def placecue_log_opened(source: Any) -> None:
    """Told when a command has opened a log; ``source`` is a :class:`placecue.Source`."""


@hookspec
def placecue_observation_classified(observation: Any, belief: Any) -> None:
    """Told of each observation and its belief (None where it was unusable)."""


@hookspec
def placecue_area_labelled(update: Any) -> None:
    """Told of each :class:`placecue.AreaUpdate`."""


@hookspec
def placecue_pair_evaluated(result: Any) -> None:
    """Told of each result of an evaluation: pair, method, score, error, as they come."""


@hookspec
def placecue_run_failed(command: str, reason: str) -> None:
    """Told, in one line, why a command that was begun has not finished."""


@hookspec
def placecue_run_finished(command: str, out: Path | None) -> None:
    """Told when a command has finished and where its results are."""
