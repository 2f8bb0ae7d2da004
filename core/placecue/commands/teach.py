"""``placecue teach``: model + labelled log -> a model that has learned these samples as well."""

from __future__ import annotations

import logging
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from placecue import progress
from placecue.atomic import made
from placecue.commands import files
from placecue.commands.features import extraction_of
from placecue.commands.logs import open_source, set_tolerance, single_logs
from placecue.commands.paths import path_of
from placecue.components.manager import Plugins, current_plugins
from placecue.errors import DataError, UsageError
from placecue.labels.at_times import LabelledAtTimes
from placecue.labels.relabelled import relabelled
from placecue.logs.joining.labels import Intervals, Seen
from placecue.observation import Observation, Part
from placecue.source import Source
from placecue.storage.model import load_model, read_manifest, save_model
from placecue.teaching import Taught, check_teachable, teach

WRITES = files.TRAINED

logger = logging.getLogger(__name__)


def run(config: dict[str, Any]) -> None:
    """Add the labelled samples of a log to a model and write it into another folder."""
    out, folder, plugins = path_of(config, "out"), path_of(config, "model"), current_plugins()
    if out.resolve() == folder.resolve():
        raise UsageError(f"out={out} is the model itself: give another folder")
    pipeline = load_model(folder, plugins.registry, config["other_versions"])
    set_tolerance(pipeline, config)
    check_teachable(pipeline)
    earlier = read_manifest(folder)["logs"]
    with extraction_of(config, plugins) as pipeline.extraction, progress.shown():
        log = _opened(config, plugins, pipeline.requires)
        logs = single_logs(log)
        if config["labels"] is None:
            _warn_of_known(logs, earlier)
        made(out)
        taught = teach(pipeline, pipeline.collect(log))
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
    return relabelled(LabelledByTable(log, known), {**config, "rooms": None})


class LabelledByTable(LabelledAtTimes):
    """A source under the labels of a table, which says what of it no observation has.

    Parameters
    ----------
    source : Source
    known : Intervals
    """

    def __init__(self, source: Source, known: Intervals) -> None:
        super().__init__(source, known.at, str(known))
        self.known = known

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations under their new labels.

        Raises
        ------
        DataError
            At the end, if none had any.
        """
        seen, met = Seen(), set[int]()
        for observation in super().__iter__():
            seen.add(observation.stamp)
            if observation.label is not None:
                met.add(bisect_right(self.known.starts, observation.stamp))
            yield observation
        if len(seen) and not met:
            raise DataError(self.known.apart(seen.first, seen.last, self.name))
        if lacking := len(self.known.labels) - len(met):
            logger.warning(
                f"{lacking} of {len(self.known.labels)} labels of {self.known.path} are of times "
                f"at which {self.name} has no observation: they teach nothing"
            )


def _warn_of_known(logs: Sequence[Source], earlier: Sequence[Mapping[str, Any]]) -> None:
    """Say which logs a model has learned from before."""
    known = {each["digest"] for each in earlier}
    for each in logs:
        if each.digest() in known:
            logger.warning(
                f"the model has learned from {each.name} before: its samples count once more"
            )


def _say(taught: Taught) -> None:
    counts = ", ".join(f"{name} {count}" for name, count in sorted(taught.counts.items()))
    print(f"learned {taught.counts.total()} samples: {counts}")
    print(
        f"of these the model had {taught.wrong_before} wrong, and has {taught.wrong_after} now; "
        "how good it is another log tells (placecue classify)"
    )
    if taught.new:
        print(f"new: {', '.join(taught.new)}")
