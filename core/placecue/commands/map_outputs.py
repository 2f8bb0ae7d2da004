"""A finished map into a folder: as data, for others' tools, and as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from placecue.atomic import write_json
from placecue.commands import files
from placecue.evaluation.map_figure import draw_semantic_map
from placecue.evaluation.surroundings import Surroundings
from placecue.free_space import Grid
from placecue.semantic_map import SemanticMap
from placecue.storage.map_files import write_map_files


def write_map(
    semantic_map: SemanticMap,
    grid: Grid | None,
    surroundings: Surroundings,
    classes: Sequence[str],
    out: Path,
    title: str,
) -> None:
    """Write a map and its picture.

    Parameters
    ----------
    semantic_map : SemanticMap
        The map.
    grid : Grid or None
        Free space.
    surroundings : Surroundings
        What the laser hit, and the labelled way.
    classes : sequence of str
        The classes that labels come from.
    out : Path
        A folder that is there.
    title : str
        What was labelled.
    """
    write_json(out / files.MAP, semantic_map.to_json())  # whatever becomes of the picture
    write_json(out / files.GEOJSON, semantic_map.to_geojson())
    write_map_files(semantic_map, grid, out)
    draw_semantic_map(
        semantic_map,
        out / files.PICTURE,
        points=surroundings.points,
        classes=classes,
        truth=surroundings.truth,
        title=title,
    )
