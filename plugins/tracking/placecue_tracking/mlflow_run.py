"""A run in MLflow: parameters, scores and files, by default in a SQLite store in ``out``."""

from __future__ import annotations

import json
import logging
import os
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from placecue import UsageError

STORE, ARTEFACTS = "mlruns.db", "mlartifacts"
#: What MLflow takes of a value, characters.
LONGEST = 6000
#: What it takes in one call.
AT_ONCE = 100
MEGABYTE = 1_000_000


class MlflowRun:
    """Keeps one run. The store is made with the first thing that is kept.

    Parameters
    ----------
    command : str
        What runs.
    config : mapping
        Its config, with ``tracking`` in it.
    out : Path
        Where it writes.

    Raises
    ------
    UsageError
        If MLflow is not installed.
    """

    def __init__(self, command: str, config: Mapping[str, Any], out: Path) -> None:
        if find_spec("mlflow") is None or find_spec("sqlalchemy") is None:
            raise UsageError(
                "tracking=mlflow needs MLflow, which is not installed: "
                "pip install 'placecue[mlflow]', or choose tracking=none"
            )
        self._command, self._config, self._out = command, config, out
        self._settings: Mapping[str, Any] = config["tracking"]
        self._begun = False
        self._scores: dict[str, list[float]] = defaultdict(list)

    @cached_property
    def _client(self) -> Any:
        # MLflow would report its use to its makers.
        os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
        from mlflow import MlflowClient

        for name in ("mlflow", "alembic"):
            logging.getLogger(name).setLevel(logging.WARNING)
        self._out.mkdir(parents=True, exist_ok=True)
        local = f"sqlite:///{(self._out / STORE).resolve()}"
        return MlflowClient(self._settings.get("store") or local)

    @cached_property
    def _run(self) -> str:
        """The run's id; it begins when first asked for."""
        name = self._settings["experiment"]
        found = self._client.get_experiment_by_name(name)
        place = (self._out / ARTEFACTS).resolve().as_uri()
        where = None if self._settings.get("store") else place
        experiment = self._client.create_experiment(name, where) if found is None else None
        number = experiment or found.experiment_id
        title = f"{self._command} {self._out.name}"
        run: str = self._client.create_run(number, run_name=title).info.run_id
        self._begun = True
        self._keep_parameters(run)
        return run

    def _keep_parameters(self, run: str) -> None:
        from mlflow.entities import Param, RunTag

        told = [Param(_name(key), value[:LONGEST]) for key, value in flat(self._config)]
        for at in range(0, len(told), AT_ONCE):
            self._client.log_batch(run, params=told[at : at + AT_ONCE])
        tags = [RunTag("placecue.command", self._command), RunTag("placecue.out", str(self._out))]
        self._client.log_batch(run, tags=tags)

    def pair(self, result: Any) -> None:
        """Keep the balanced accuracy of a pair, numbered as they come."""
        if result.error:
            return
        name = f"balanced_accuracy/{result.pair.experiment}/{result.method}"
        scores = self._scores[name]
        self._client.log_metric(self._run, _name(name), result.score, step=len(scores))
        scores.append(result.score)

    def failed(self, reason: str) -> None:
        """Close a run that broke off; one of which nothing was kept leaves nothing."""
        if self._begun:
            self._client.set_tag(self._run, "placecue.error", reason[:LONGEST])
            self._client.set_terminated(self._run, "FAILED")

    def finished(self) -> None:
        """Keep scores and files, and close the run."""
        for name, scores in self._scores.items():
            self._client.log_metric(self._run, _name(f"mean_{name}"), sum(scores) / len(scores))
        for method, score in _scores_in(self._out / "metrics.json"):
            self._client.log_metric(self._run, _name(f"balanced_accuracy/{method}"), score)
        left_out = []
        for path in self._files():
            inside = path.relative_to(self._out)
            if path.stat().st_size > self._settings["largest_file"] * MEGABYTE:
                left_out.append(str(inside))
                continue
            folder = None if inside.parent == Path() else str(inside.parent)
            self._client.log_artifact(self._run, str(path), folder)
        if left_out:
            self._client.set_tag(self._run, "placecue.left_out", ", ".join(left_out)[:LONGEST])
        self._client.set_terminated(self._run)

    def _files(self) -> Iterator[Path]:
        for path in sorted(self._out.rglob("*")):
            inside = path.relative_to(self._out)
            own = inside.parts[0] == ARTEFACTS or inside.parts[0].startswith(STORE)
            if path.is_file() and not own and not path.name.startswith("."):
                yield path


def flat(config: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield the leaves of a config with their dotted keys; lists as JSON."""
    if isinstance(config, Mapping) and config:
        for key, value in config.items():
            yield from flat(value, f"{prefix}.{key}" if prefix else str(key))
    else:
        yield prefix, config if isinstance(config, str) else json.dumps(config, default=str)


def _name(words: str) -> str:
    """Put what MLflow takes in names in the place of other characters."""
    return re.sub(r"[^\w\-. :/]", "_", words)


def _scores_in(path: Path) -> Iterator[tuple[str, float]]:
    """Yield the balanced accuracy of each method of a labelled log, where there are any."""
    if path.is_file():
        for method, told in json.loads(path.read_text(encoding="utf-8"))["methods"].items():
            yield method, told["balanced_accuracy"]
