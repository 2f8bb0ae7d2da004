"""``placecue train``: log(s) -> model folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from placecue import progress
from placecue.commands import show
from placecue.commands.logs import open_source, path_of, single_logs
from placecue.composition import build_pipeline
from placecue.discovery.manager import current_plugins
from placecue.pipeline import Pipeline
from placecue.storage.atomic import made
from placecue.storage.model import save_model

OUT_IS_FOLDER = True


def run(config: dict[str, Any]) -> None:
    """Train a pipeline and write its model folder."""
    out = path_of(config, "out")
    pipeline = train(config, out)
    show.chosen_parameters(pipeline)
    print(f"model of {len(pipeline.classes)} classes ({', '.join(pipeline.classes)}) in {out}")
    print(f"next: placecue classify model={out} log=FILE, or placecue label model={out} log=FILE")
    current_plugins().tell("run_finished", command="train", out=out)


def train(config: dict[str, Any], out: Path) -> Pipeline:
    """Train the pipeline that a config describes and save it into ``out``."""
    plugins = current_plugins()
    pipeline = build_pipeline(config, plugins.registry)
    parts = (*pipeline.requires, "label")
    log = open_source(config, plugins, parts=parts)
    logs = single_logs(log)
    integration = None
    if config.get("integration_log"):
        integration = open_source(config, plugins, "integration_log", parts)
        logs += single_logs(integration)
    made(out)
    with progress.shown():
        pipeline.fit(log, integration)
    save_model(pipeline, out, plugins.registry, trained_on=logs, config=config)
    return pipeline
