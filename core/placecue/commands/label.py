"""``placecue label``: model + log -> semantic map, online in one pass."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from placecue import contracts, progress
from placecue.atomic import made, write_json
from placecue.commands import as_json, files, reporting, show, tables
from placecue.commands.features import extraction_of
from placecue.commands.map_outputs import write_map
from placecue.commands.models import model_and_log
from placecue.commands.paths import path_of
from placecue.commands.straightening import Straightening, advice, trajectory
from placecue.commands.viewers import Viewers, check_viewers, written
from placecue.components.build import build
from placecue.components.manager import current_plugins
from placecue.evaluation.report.labelling import run_page
from placecue.evaluation.report.sampled import MistakeSample
from placecue.evaluation.surroundings import Surroundings
from placecue.evaluation.tally import Tally
from placecue.free_space import FreeSpace
from placecue.guard import call
from placecue.labelling import Listener, run_log
from placecue.listening import PluginListeners
from placecue.logs.writing.annotated import LAYOUT, AnnotatedLog, write_layout
from placecue.semantic_map import SemanticMap
from placecue.sharpness import Sharpness
from placecue.storage import map_files
from placecue.storage.belief_table import belief_table
from placecue.surfaces import with_surfaces

#: What a page says of a map that no model of the building made.
STARTER = (
    "Labelled by the starter, which has seen no room of this building, only drawn plans and the "
    "photographs of a network: a beginning. A model of labels of your own knows it better."
)
WRITES = (*files.LABELLED, *files.ON_REQUEST)


def run(config: dict[str, Any]) -> dict[str, float]:
    """Label the areas of a log and write the map, a picture of it and the annotated log.

    Returns
    -------
    dict of str to float
        The balanced accuracy, where the log is labelled.
    """
    out, tally = path_of(config, "out"), Tally()
    notes: list[str] = []
    in_json = as_json.wanted(config)
    semantic_map = label(config, out, tally, notes.append if in_json else print)
    files_written = [
        *results(out, bool(tally.counts)),
        *written(config, out),
        *reporting.written(config, out),
    ]
    if in_json:
        scores = tally.to_json() if tally.counts else None
        told = {"map": semantic_map.to_json(), "scores": scores, "notes": notes}
        as_json.tell({**told, "files": as_json.paths(files_written)})
    else:
        _print(semantic_map, tally, files_written)
    current_plugins().tell("run_finished", command="label", out=out)
    return show.accuracy(tally)


def _print(semantic_map: SemanticMap, tally: Tally, files_written: list[tuple[str, Path]]) -> None:
    areas = [area for area in semantic_map.areas if area.label != "unknown"]
    print(f"{len(semantic_map.areas)} areas, {len(areas)} of them labelled")
    if tally.counts:
        show.scores(tally)
    tables.written(files_written)


def label(
    config: dict[str, Any], out: Path, tally: Tally, tell: Callable[[str], None] = print
) -> SemanticMap:
    """Run a model over a log and write everything that comes of it into ``out``.

    ``tell`` takes what speaks against the map.
    """
    check_viewers(config)
    plugins = current_plugins()
    pipeline, log = model_and_log(config, plugins, ("scan", "pose", "label"))
    accumulator = build(config["accumulator"], "accumulator", plugins.registry)
    surroundings, sample, space = Surroundings(), MistakeSample(), FreeSpace()
    straightening, sharpness = Straightening(log), Sharpness()
    accumulator = straightening.following(accumulator)
    reported = reporting.is_wanted(config)
    tally.says_unknown = pipeline.rejection_ is not None
    with ExitStack() as stack, progress.shown():
        pipeline.extraction = stack.enter_context(extraction_of(config, plugins))
        made(out)
        annotated = stack.enter_context(AnnotatedLog(out / files.ANNOTATED, pipeline.classes))
        viewers = Viewers(config, out, pipeline.classes, accumulator, space, stack)
        listeners: list[Listener] = [
            tally,
            surroundings,
            space,
            straightening,
            *([] if straightening.sources else [sharpness]),
            annotated,
            stack.enter_context(belief_table(out / files.BELIEFS)),
            PluginListeners(plugins),
            *([sample] if reported else []),
            *viewers.listeners,
        ]
        run_log(pipeline, log, listeners, accumulator=accumulator, batch=config["batch"])
        semantic_map: SemanticMap = call(accumulator, "semantic_map", check=contracts.semantic_map)
        surroundings, space = straightening.drawn(surroundings, space)
        grid = space.grid()
        semantic_map = straightening.sure(with_surfaces(semantic_map, grid))
        annotated.close_with(semantic_map)
        viewers.close_with(semantic_map)
        doubts: list[str] = call(accumulator, "warnings", check=contracts.texts)
    write_layout(out, semantic_map.frame)
    straightening.write(out)
    write_map(semantic_map, grid, surroundings, pipeline.classes, out, log.name, config["model"])
    if tally.counts:
        write_json(out / files.SCORES, tally.to_json())
    facts = reporting.facts(config, log.name)
    doubts = [*advice(sharpness), *doubts]
    reporting.write(config, out, lambda: run_page(
        f"Map of {log.name}", facts, tally, sample, semantic_map, out / files.PICTURE,
        [*([] if config["model"] else [STARTER]), *doubts],
    ))  # fmt: skip
    for doubt in doubts:
        tell(f"note: {doubt}")
    return semantic_map


def results(out: Path, scored: bool) -> list[tuple[str, Path]]:
    """Return what :func:`label` writes, with a word on each file."""
    return [
        *([("scores", out / files.SCORES)] if scored else []),
        ("semantic map", out / files.MAP),
        ("as GeoJSON", out / files.GEOJSON),
        ("for Nav2", out / map_files.ROUTE_GRAPH),
        ("", out / map_files.ABOUT),
        ("its nodes", out / map_files.NODES),
        ("its picture", out / files.PICTURE),
        ("", out / files.DRAWING),
        ("beliefs", out / files.BELIEFS),
        *trajectory(out),
        ("annotated log", out / files.ANNOTATED),
        ("its layout for Foxglove or Lichtblick", out / LAYOUT),
    ]
