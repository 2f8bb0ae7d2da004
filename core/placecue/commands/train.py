"""``placecue train``: log(s) -> model folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from placecue import progress
from placecue.atomic import made
from placecue.checks import check_flag
from placecue.commands import as_json, files, reporting, show
from placecue.commands.features import extraction_of
from placecue.commands.logs import open_source, set_tolerance, single_logs
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.components.pipelines import build_pipeline
from placecue.evaluation.report.training import training_page
from placecue.evaluation.training_report import write_training_report
from placecue.pipeline import Pipeline
from placecue.storage.model import read_manifest, save_model

WRITES = files.TRAINED


def run(config: dict[str, Any]) -> dict[str, float]:
    """Train a pipeline and write its model folder.

    Returns
    -------
    dict of str to float
        What the searches say: the best balanced accuracy of each.
    """
    out = path_of(config, "out")
    as_json.wanted(config)
    pipeline, report = train(config, out)
    best = show.best_of_searches(pipeline)
    if as_json.wanted(config):
        classes = list(pipeline.classes)
        told = {"model": str(out), "classes": classes, "balanced_accuracy_of_searches": best}
        as_json.tell({**told, "files": as_json.paths(report)})
    else:
        show.training(pipeline, report)
        print(f"model of {len(pipeline.classes)} classes ({', '.join(pipeline.classes)}) in {out}")
        print(f"next: placecue classify {out} LOG, or placecue label {out} LOG")
    current_plugins().tell("run_finished", command="train", out=out)
    return best


def train(config: dict[str, Any], out: Path) -> tuple[Pipeline, list[tuple[str, Path]]]:
    """Train the pipeline that a config describes and save it into ``out``.

    Returns
    -------
    Pipeline
        As trained.
    list of (str, Path)
        What is in ``out`` besides the model; see :func:`write_training_report`.
    """
    plugins = current_plugins()
    pipeline = build_pipeline(config, plugins.registry)
    set_tolerance(pipeline, config)
    reporting.is_wanted(config)  # wrong words are told before the training, not after it
    force: bool = config.get("force_training_scores", False)
    check_flag("force_training_scores", force)
    parts = (*pipeline.requires, "label")
    with extraction_of(config, plugins) as pipeline.extraction, progress.shown():
        log = open_source(config, plugins, parts=parts)
        logs = single_logs(log)
        integration = None
        if config.get("integration_log"):
            integration = open_source(config, plugins, "integration_log", parts)
        made(out)
        pipeline.fit(log, integration, reliability=True, force_training_scores=force)
    if integration is not None and pipeline.held_out_ is not None:
        logs += single_logs(integration)
    try:
        report = write_training_report(pipeline, out)
    finally:
        # Last, as its manifest says that all is there; and a picture that fails loses no model.
        save_model(pipeline, out, plugins.registry, trained_on=logs, config=config)
    reporting.write(config, out, lambda: training_page(
        pipeline, out, read_manifest(out), reporting.command_line()
    ))  # fmt: skip
    return pipeline, [*report, *reporting.written(config, out)]
