"""``placecue live``: model + a robot that drives -> beliefs and a growing map, served likewise."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from threading import Timer
from typing import Any

from placecue import contracts
from placecue.accumulator import Accumulator, AreaUpdate
from placecue.atomic import made, write_json
from placecue.belief import Belief
from placecue.checks import check_number, check_whole
from placecue.commands import files, show, tables
from placecue.commands.map_outputs import write_map
from placecue.commands.models import model_and_log
from placecue.commands.onlookers import check_onlookers, onlookers_of
from placecue.commands.paths import path_of
from placecue.commands.straightening import Straightening, trajectory
from placecue.commands.viewers import Viewers, check_viewers, written
from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.errors import UsageError
from placecue.evaluation.surroundings import Surroundings
from placecue.evaluation.tally import Tally
from placecue.free_space import FreeSpace
from placecue.guard import call
from placecue.interrupting import stopped_by_interrupt
from placecue.labelling import Listener, run_log
from placecue.listening import PluginListeners
from placecue.logs.live.log import LiveLog
from placecue.observation import Observation
from placecue.pipeline import Pipeline
from placecue.semantic_map import SemanticMap
from placecue.serving.onlooker import OnlookersTold
from placecue.serving.pace import Pace
from placecue.source import Source, innermost
from placecue.storage import map_files
from placecue.storage.belief_table import belief_table

WRITES = (files.BELIEFS, files.SCORES, *files.MAP_FILES, *files.ON_REQUEST)


def run(config: dict[str, Any]) -> dict[str, float]:
    """Label what a robot sends while it drives, until Ctrl-C; then write the map.

    Returns
    -------
    dict of str to float
        The balanced accuracy, where the robot sends labels.

    Raises
    ------
    UsageError
        If an option is no such thing, ``log`` no single address, or a port is taken.
    """
    check_onlookers(config)
    check_viewers(config)
    check_whole("workers", config["workers"], least=1)
    if config["seconds"] is not None:
        check_number("seconds", config["seconds"], above=0)
    plugins, out, tally = current_plugins(), path_of(config, "out"), Tally()
    pipeline, source = model_and_log(config, plugins, ("scan", "pose", "label"))
    robot = _robot(source)
    built: Accumulator = build(config["accumulator"], "accumulator", plugins.registry)
    accumulator = Straightening(source).following(built)
    tally.says_unknown = pipeline.rejection_ is not None
    pace = Pace(lambda: robot.arrived)
    with _side_by_side(pipeline, config["workers"]):
        semantic_map = label(config, pipeline, source, robot, accumulator, tally, pace, out)
    if tally.counts:
        write_json(out / files.SCORES, tally.to_json())
    _print(semantic_map, robot, pace, tally, out, written(config, out))
    for doubt in call(accumulator, "warnings", check=contracts.texts):
        print(f"note: {doubt}")
    plugins.tell("run_finished", command="live", out=out)
    return show.accuracy(tally)


def label(
    config: Mapping[str, Any],
    pipeline: Pipeline,
    source: Source,
    robot: LiveLog,
    accumulator: Accumulator,
    tally: Tally,
    pace: Pace,
    out: Path,
) -> SemanticMap:
    """Label what comes until it ends, telling onlookers, and write the map into ``out``."""
    surroundings, space, straightening = Surroundings(), FreeSpace(), Straightening(source)
    with ExitStack() as stack:
        stack.callback(robot.stop)
        shown = lambda: _shown(robot, pace)  # noqa: E731
        onlookers = onlookers_of(config, source.name, pipeline.classes, shown, stack)
        told = OnlookersTold(onlookers, accumulator, space, config["map_every"])
        made(out)
        viewers = Viewers(config, out, pipeline.classes, accumulator, space, stack)
        listeners: list[Listener] = [
            _Until(config["seconds"], robot.stop),
            pace,
            tally,
            surroundings,
            space,
            straightening,
            stack.enter_context(belief_table(out / files.BELIEFS)),
            PluginListeners(current_plugins()),
            *viewers.listeners,
            told,
        ]
        with stopped_by_interrupt(robot.stop):
            run_log(pipeline, source, listeners, accumulator=accumulator, batch=1)
        print("progress: writing the map", file=sys.stderr, flush=True)
        surroundings, told.space = straightening.drawn(surroundings, space)
        semantic_map, grid = told.end()
        semantic_map = straightening.sure(semantic_map)
        straightening.write(out)
        viewers.close_with(semantic_map)
        write_map(
            semantic_map, grid, surroundings, pipeline.classes, out, source.name, config["model"]
        )
    return semantic_map


def _robot(source: Source) -> LiveLog:
    found = innermost(source)
    if not isinstance(found, LiveLog):
        raise UsageError(
            "live follows one robot: give one address such as ws://127.0.0.1:8765, and no source="
        )
    return found


def _side_by_side(pipeline: Pipeline, workers: int) -> ExitStack:
    """Let the cues of a pipeline go side by side in the ``with`` block that is returned."""
    stack = ExitStack()
    if workers > 1:
        pipeline.pool = stack.enter_context(ThreadPoolExecutor(workers, "placecue cue"))
    return stack


class _Until:
    """Stops so many seconds after the first observation; a listener."""

    def __init__(self, seconds: float | None, stop: Callable[[], None]) -> None:
        self.seconds = seconds
        self.stop = stop
        self._timer: Timer | None = None

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        if self._timer is None and self.seconds is not None:
            self._timer = Timer(self.seconds, self.stop)
            self._timer.daemon = True
            self._timer.start()


def _shown(robot: LiveLog, pace: Pace) -> dict[str, str]:
    """Return what the page shows of the pace."""
    median, late = pace.latency
    return {
        "observations": str(pace.count),
        "a second": f"{pace.rate:.1f}",
        "latency, median": f"{median:.0f} ms",
        "latency, 99th percentile": f"{late:.0f} ms",
        "dropped": str(robot.dropped["observations"]),
    }


def _print(
    semantic_map: SemanticMap,
    robot: LiveLog,
    pace: Pace,
    tally: Tally,
    out: Path,
    more: Sequence[tuple[str, Path]],
) -> None:
    areas = [area for area in semantic_map.areas if area.label != "unknown"]
    print(f"{len(semantic_map.areas)} areas, {len(areas)} of them labelled")
    median, late = pace.latency
    dropped = robot.dropped
    print(
        f"{pace.count} observations; dropped, as labelling did not keep up: "
        f"{dropped['observations']} observations, {dropped['messages']} messages"
    )
    print(f"latency of the last: median {median:.1f} ms, 99th percentile {late:.1f} ms")
    if tally.counts:
        show.scores(tally)
    tables.written(
        [
            *([("scores", out / files.SCORES)] if tally.counts else []),
            ("semantic map", out / files.MAP),
            ("as GeoJSON", out / files.GEOJSON),
            ("for Nav2", out / map_files.ROUTE_GRAPH),
            ("", out / map_files.ABOUT),
            ("its nodes", out / map_files.NODES),
            ("its picture", out / files.PICTURE),
            ("", out / files.DRAWING),
            ("beliefs", out / files.BELIEFS),
            *trajectory(out),
            *more,
        ]
    )
