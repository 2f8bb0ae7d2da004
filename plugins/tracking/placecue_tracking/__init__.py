"""Listens to the events of a run and keeps them elsewhere, where ``tracking=`` says so."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from placecue import hookimpl

if TYPE_CHECKING:
    from placecue_tracking.mlflow_run import MlflowRun

#: The run that is tracked; a process has one at a time.
_tracked: list[MlflowRun] = []


@hookimpl
def placecue_run_started(command: str, config: Mapping[str, Any], out: Path | None) -> None:
    """Get ready where ``tracking=mlflow``; anything else imports nothing."""
    _tracked.clear()
    tracking = config.get("tracking")
    if isinstance(tracking, Mapping) and tracking.get("name") == "mlflow" and out is not None:
        from placecue_tracking.mlflow_run import MlflowRun

        _tracked.append(MlflowRun(command, config, out))


@hookimpl
def placecue_pair_evaluated(result: Any) -> None:
    """Keep the score of a pair."""
    for run in _tracked:
        run.pair(result)


@hookimpl
def placecue_run_failed(reason: str) -> None:
    """Say that the run failed, if anything of it was kept."""
    while _tracked:
        _tracked.pop().failed(reason)


@hookimpl
def placecue_run_finished(command: str, out: Path | None) -> None:
    """Keep scores and files."""
    while _tracked:
        _tracked.pop().finished()
