"""``placecue demo``: makes two logs, trains on one, classifies and labels the other.

With ``starter=true`` the second is labelled as if nobody had labelled anything.
"""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import Any

from placecue.checks import check_flag
from placecue.commands import convert, files, label, reporting, show, tables, train
from placecue.commands.logs import on_error_of
from placecue.commands.paths import path_of
from placecue.components.manager import current_plugins
from placecue.errors import PlacecueError, UsageError
from placecue.evaluation.tally import Tally
from placecue.semantic_map import UNKNOWN
from placecue.starter.pipeline import Starter

WRITES = files.DEMONSTRATED

#: What the simulated office has, and its rooms as the table of objects calls them.
PLACES = ("corridor", "kitchen", "office", "printer_area")
NAMES = {"one_person_office": "office", "two_person_office": "office"}


def run(config: dict[str, Any]) -> None:
    """Go from nothing to a semantic map and say where everything is."""
    started, out = perf_counter(), path_of(config, "out")
    reporting.is_wanted(config)
    on_error_of(config)  # wrong words are told before the recording, not after it
    by_starter = config["starter"]
    check_flag("starter", by_starter)
    if config["places"] is not None and not by_starter:
        raise UsageError("places= is for the starter: give starter=true with it")
    logs = [out / name for name in files.LOGS]
    for number, log in enumerate(logs, 1):
        print(f"recording {log} in a simulated office ...")
        convert.convert({**config, "source": {**config["source"], "run": number}}, log)

    model = None if by_starter else _trained(config, logs[0], out / files.MODEL)
    unseen = "without its labels" if by_starter else "which the model has not seen"
    print(f"\nclassifying and labelling {logs[1].name}, {unseen} ...")
    tally, fresh = Tally(), {"model": model, "other_versions": "refuse"}
    labelled = {**config, **fresh, "source": _reading(logs[1])}
    if by_starter:
        labelled |= {"places": _places(config), "label_map": NAMES, "unmapped_labels": "keep"}
    semantic_map = label.label(labelled, out, tally)
    if not tally.counts:
        raise PlacecueError(f"{logs[1]} gave no belief on a labelled observation: nothing to score")
    show.scores(tally)

    named = [area for area in semantic_map.areas if area.label != UNKNOWN]
    print(f"\n{len(semantic_map.areas)} areas, {len(named)} of them labelled")
    made = [("logs", out / "run*.mcap"), *([("model", model)] if model else [])]
    tables.written([*made, *label.results(out, True), *reporting.written(config, out)])
    print(
        f"\ndone in {perf_counter() - started:.0f} s. next:\n"
        f"  placecue info log={logs[1]}\n"
        f"  placecue train log={logs[0]} cue=laser integrator=none out={out / 'laser'}\n"
        f"  placecue classify model={out / 'laser'} log={logs[1]} out={out / 'by_laser'}"
    )
    current_plugins().tell("run_finished", command="demo", out=out)


def _trained(config: dict[str, Any], log: Path, out: Path) -> Path:
    print(f"training {' + '.join(config['cues'])} on {log.name} ...")
    show.training(*train.train({**config, "source": _reading(log)}, out))
    return out


def _places(config: dict[str, Any]) -> Any:
    """Return the places that the starter is told of: kinds of rooms where it can tell them."""
    if config["places"] is None and Starter(current_plugins().registry).sees_objects:
        return list(PLACES)
    return config["places"]


def _reading(log: Path) -> dict[str, Any]:
    return {"plugin": "mcap", "path": str(log)}
