"""``placecue teach``: model + labelled log -> a model that has learned these samples as well."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from placecue import progress
from placecue.atomic import made
from placecue.commands import files
from placecue.commands.features import extraction_of
from placecue.commands.logs import open_source, set_tolerance, single_logs
from placecue.commands.paths import path_of
from placecue.components.manager import Plugins, current_plugins
from placecue.errors import UsageError
from placecue.labels.at_times import LabelledAtTimes
from placecue.labels.relabelled import relabelled
from placecue.logs.joining.labels import Intervals
from placecue.observation import Part
from placecue.source import Source
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
        log = _opened(config, plugins, pipeline.requires)
        logs = single_logs(log)
        made(out)
        taught = teach(pipeline, pipeline.collect(log))
    earlier = read_manifest(folder)["logs"]
    save_model(pipeline, out, plugins.registry, trained_on=logs, earlier=earlier)
    _say(taught)
    print(f"model of {len(pipeline.classes)} classes ({', '.join(pipeline.classes)}) in {out}")
    print(f"next: placecue label model={out} log=FILE, or placecue suggest model={out} log=FILE")
    plugins.tell("run_finished", command="teach", out=out)


def _opened(config: dict[str, Any], plugins: Plugins, parts: Sequence[Part]) -> Source:
    """Open the log, under the labels of a table where there is one."""
    if config["labels"] is None:
        return open_source(config, plugins, parts=(*parts, "label"))
    known = Intervals.from_csv(config["labels"])
    log = open_source({**config, "rooms": None, "label_map": None}, plugins, parts=parts)
    return relabelled(LabelledAtTimes(log, known.at, str(known)), {**config, "rooms": None})


def _say(taught: Taught) -> None:
    counts = ", ".join(f"{name} {count}" for name, count in sorted(taught.counts.items()))
    print(f"learned {taught.counts.total()} samples: {counts}")
    if taught.new:
        print(f"new: {', '.join(taught.new)}")
