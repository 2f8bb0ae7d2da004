"""What is written of a labelled drive only where it is asked for: for viewers, and as a film."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from placecue.accumulator import Accumulator
from placecue.checks import check_choice, check_flag, check_whole
from placecue.commands.files import FILM
from placecue.evaluation.film import Film, draw_film
from placecue.free_space import FreeSpace
from placecue.labelling import Listener
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
    if config.get("film") is not None:
        check_whole("film", config["film"], least=1)


class Viewers:
    """What was asked for of one run.

    Parameters
    ----------
    config : mapping
        Of the command.
    out : Path
        Where to.
    classes : sequence of str
        Those of the model.
    accumulator : Accumulator
        Whose map it is.
    space : FreeSpace
        A listener that is told before these.
    stack : ExitStack
        Closes what is open.
    """

    def __init__(
        self,
        config: Mapping[str, Any],
        out: Path,
        classes: Sequence[str],
        accumulator: Accumulator,
        space: FreeSpace,
        stack: ExitStack,
    ) -> None:
        self.out = out
        self.classes = classes
        self.scene_graph = bool(config.get("scene_graph"))
        self.recording = self.film = None
        if config.get("viewer") is not None:
            self.recording = stack.enter_context(RerunLog(out / RECORDING, classes))
        if config.get("film") is not None:
            self.film = Film(config["film"], accumulator, space)

    @property
    def listeners(self) -> list[Listener]:
        """Who is to be told of each observation."""
        return [each for each in (self.recording, self.film) if each is not None]

    def close_with(self, semantic_map: SemanticMap) -> None:
        """Write the finished map for those who asked."""
        if self.recording is not None:
            self.recording.close_with(semantic_map)
        if self.film is not None and (stills := self.film.stills()):
            draw_film(stills, self.out / FILM, self.classes)
        if self.scene_graph:
            write_scene_graph(semantic_map, self.out / SCENE_GRAPH)


def written(config: Mapping[str, Any], out: Path) -> list[tuple[str, Path]]:
    """Return what was asked for, with a word on each file."""
    return [
        *([("for rerun", out / RECORDING)] if config.get("viewer") else []),
        *([("as a film", out / FILM)] if config.get("film") else []),
        *([("for spark_dsg", out / SCENE_GRAPH)] if config.get("scene_graph") else []),
    ]
