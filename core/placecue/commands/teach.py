"""``placecue teach``: model + labelled log -> a model that has learned these samples as well."""

from __future__ import annotations

from typing import Any

from placecue import progress
from placecue.atomic import made
from placecue.commands import files
from placecue.commands.features import extraction_of
from placecue.commands.logs import open_source, set_tolerance, single_logs
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.errors import UsageError
from placecue.labels.at_times import LabelledAtTimes
from placecue.logs.joining.labels import Intervals
from placecue.storage.model import load_model, read_manifest, save_model
from placecue.teaching import Taught, check_teachable, teach

WRITES = files.TRAINED


def run(config: dict[str, Any]) -> None:
    """Add the labelled samples of a log to a model and write it into another folder."""
    out, folder, plugins = path_of(config, "out"), path_of(config, "model"), current_plugins()
    if out.resolve() == folder.resolve():
        raise UsageError(f"out={out} is the model itself: give another folder")
    pipeline = load_model(folder, plugins.registry, config["other_versions"])
    set_tolerance(pipeline, config)
    check_teachable(pipeline)
    with extraction_of(config, plugins) as pipeline.extraction, progress.shown():
        log = open_source(config, plugins, parts=(*pipeline.requires, "label"))
        logs = single_logs(log)
        if config["labels"] is not None:
            known = Intervals.from_csv(config["labels"])
            log = LabelledAtTimes(log, known.at, str(known))
        made(out)
        taught = teach(pipeline, pipeline.collect(log))
    earlier = read_manifest(folder)["logs"]
    save_model(pipeline, out, plugins.registry, trained_on=logs, earlier=earlier)
    _say(taught)
    print(f"model of {len(pipeline.classes)} classes ({', '.join(pipeline.classes)}) in {out}")
    print(f"next: placecue label model={out} log=FILE, or placecue suggest model={out} log=FILE")
    plugins.tell("run_finished", command="teach", out=out)


def _say(taught: Taught) -> None:
    counts = ", ".join(f"{name} {count}" for name, count in sorted(taught.counts.items()))
    print(f"learned {taught.counts.total()} samples: {counts}")
    if taught.new:
        print(f"new: {', '.join(taught.new)}")
