"""``placecue classify``: model + log -> beliefs, and scores where the log is labelled."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Any

from placecue import progress
from placecue.atomic import made, write_json
from placecue.commands import as_json, files, reporting, show, tables
from placecue.commands.features import extraction_of
from placecue.commands.models import model_and_log
from placecue.commands.paths import path_of
from placecue.commands.straightening import Straightening, trajectory
from placecue.components.manager import current_plugins
from placecue.evaluation.report.labelling import run_page
from placecue.evaluation.report.sampled import MistakeSample
from placecue.evaluation.tally import Tally
from placecue.labelling import Listener, run_log
from placecue.listening import PluginListeners
from placecue.logs.writing.annotated import AnnotatedLog
from placecue.storage.belief_table import belief_table

WRITES = files.CLASSIFIED


def run(config: dict[str, Any]) -> dict[str, float]:
    """Write the beliefs of a log as CSV and MCAP, and score them where it is labelled.

    Returns
    -------
    dict of str to float
        The balanced accuracy, where it is labelled.
    """
    out, plugins = path_of(config, "out"), current_plugins()
    pipeline, log = model_and_log(config, plugins, ("pose", "label"))
    table, annotated, metrics = out / files.BELIEFS, out / files.BELIEFS_LOG, out / files.SCORES
    tally, sample, straightening = Tally(), MistakeSample(), Straightening(log)
    as_json.wanted(config)
    reporting.is_wanted(config)  # wrong words are told before the run, not after it
    tally.says_unknown = pipeline.rejection_ is not None
    with ExitStack() as stack, progress.shown():
        pipeline.extraction = stack.enter_context(extraction_of(config, plugins))
        made(out)
        listeners: list[Listener] = [
            tally,
            stack.enter_context(belief_table(table)),
            stack.enter_context(AnnotatedLog(annotated, pipeline.classes)),
            PluginListeners(plugins),
            *([sample] if reporting.is_wanted(config) else []),
        ]
        run_log(pipeline, log, listeners, batch=config["batch"])
    results = [("beliefs", table), ("beliefs with the log, for Foxglove", annotated)]
    straightening.write(out)
    results += trajectory(out)
    if tally.counts:
        if not as_json.wanted(config):
            show.scores(tally)
        results.append(("scores", write_json(metrics, tally.to_json())))
    facts = reporting.facts(config, log.name)
    reporting.write(config, out, lambda: run_page(f"Beliefs of {log.name}", facts, tally, sample))
    results += reporting.written(config, out)
    if as_json.wanted(config):
        scores = tally.to_json() if tally.counts else None
        as_json.tell({"log": log.name, "scores": scores, "files": as_json.paths(results)})
    else:
        tables.written(results)
    plugins.tell("run_finished", command="classify", out=out)
    return show.accuracy(tally)
