"""A finished map into a folder: as data, for others' tools, and as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from placecue.atomic import write_json
from placecue.commands import files
from placecue.evaluation.map_figure import map_figure
from placecue.evaluation.pictures import save_picture
from placecue.evaluation.surroundings import Surroundings, walls
from placecue.free_space import Grid
from placecue.semantic_map import SemanticMap
from placecue.storage.map_files import write_map_files


def write_map(
    semantic_map: SemanticMap,
    grid: Grid | None,
    surroundings: Surroundings,
    classes: Sequence[str],
    out: Path,
    log_name: str,
    model: str | None,
) -> None:
    """Write a map and its picture.

    Parameters
    ----------
    semantic_map : SemanticMap
        The map.
    grid : Grid or None
        Free space.
    surroundings : Surroundings
        What the laser hit, the labelled way, and what was believed on it.
    classes : sequence of str
        The classes that labels come from.
    out : Path
        A folder that is there.
    log_name : str
        What was labelled.
    model : str or None
        The model folder; None for the starter.
    """
    write_json(out / files.MAP, semantic_map.to_json())  # whatever becomes of the picture
    write_json(out / files.GEOJSON, semantic_map.to_geojson())
    write_map_files(semantic_map, grid, out)
    figure = map_figure(
        semantic_map,
        points=walls(surroundings.points, grid),
        classes=classes,
        beliefs=surroundings.beliefs,
        truth=surroundings.truth,
        title=log_name,
        about=f"labelled by {model or 'the starter'}, {datetime.now().astimezone():%Y-%m-%d}",
    )
    save_picture(figure, out / files.PICTURE)
    save_picture(figure, out / files.DRAWING)
