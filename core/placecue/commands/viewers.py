"""What is written of a labelled drive only where it is asked for: for rerun, and for spark_dsg."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from placecue.checks import check_choice, check_flag
from placecue.logs.writing.rerun_log import RECORDING, RerunLog, check_rerun
from placecue.semantic_map import SemanticMap
from placecue.storage.scene_graph import SCENE_GRAPH, check_scene_graphs, write_scene_graph

VIEWERS = ("rerun",)


def check_viewers(config: Mapping[str, Any]) -> None:
    """Raise UsageError if what is asked for is not known, or not installed."""
    if (viewer := config.get("viewer")) is not None:
        check_choice("viewer", viewer, VIEWERS)
        check_rerun()
    check_flag("scene_graph", config.get("scene_graph", False))
    if config.get("scene_graph"):
        check_scene_graphs()


def recordings(
    config: Mapping[str, Any], out: Path, classes: Sequence[str], stack: ExitStack
) -> list[RerunLog]:
    """Open what is to be told of each observation; the stack closes it."""
    if config.get("viewer") is None:
        return []
    return [stack.enter_context(RerunLog(out / RECORDING, classes))]


def write_viewers(
    config: Mapping[str, Any], opened: Sequence[RerunLog], semantic_map: SemanticMap, out: Path
) -> None:
    """Write the finished map for those who asked."""
    for each in opened:
        each.close_with(semantic_map)
    if config.get("scene_graph"):
        write_scene_graph(semantic_map, out / SCENE_GRAPH)


def written(config: Mapping[str, Any], out: Path) -> list[tuple[str, Path]]:
    """Return what was asked for, with a word on each file."""
    return [
        *([("for rerun", out / RECORDING)] if config.get("viewer") else []),
        *([("for spark_dsg", out / SCENE_GRAPH)] if config.get("scene_graph") else []),
    ]
