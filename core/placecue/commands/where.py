"""``placecue where``: a map and a position -> which room, and how sure."""

from __future__ import annotations

import json
from math import isfinite
from pathlib import Path
from typing import Any

from placecue.commands import files
from placecue.commands.paths import path_of
from placecue.errors import DataError, UsageError, told
from placecue.semantic_map import UNKNOWN, Area, SemanticMap

WRITES = None


def run(config: dict[str, Any]) -> None:
    """Print which area of a map a position lies in."""
    path = path_of(config, "map")
    semantic_map = read_map(path / files.MAP if path.is_dir() else path)
    x, y = (_number(name, config[name]) for name in ("x", "y"))
    found = semantic_map.at(x, y, _number("within", config["within"]))
    if found is None:
        raise DataError(
            f"({x:g}, {y:g}) lies in no area of {path}, in frame '{semantic_map.frame}'"
            f"{_extent(semantic_map)}"
        )
    print(json.dumps(_as_data(found), indent=2) if config["json"] else _as_text(found))


def read_map(path: Path) -> SemanticMap:
    """Read a map that ``placecue label`` wrote.

    Raises
    ------
    DataError
        If there is none, or it is not one.
    """
    try:
        data = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise DataError(f"cannot read the map {path}: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise DataError(f"{path} is not JSON: {told(error)}") from error
    if not isinstance(data, dict):
        raise DataError(f"{path} is not a semantic map: give what placecue label wrote")
    return SemanticMap.from_json(data)


def _as_text(area: Area) -> str:
    ranking = sorted(area.probabilities.items(), key=lambda each: -each[1])
    others = ", ".join(f"{name} {100 * share:.1f} %" for name, share in ranking)
    if area.label == UNKNOWN:
        return f"{UNKNOWN} (area {area.id})" + (f": {others}" if others else "")
    return f"{area.label} {100 * area.confidence:.1f} % (area {area.id}): {others}"


def _as_data(area: Area) -> dict[str, Any]:
    return {
        "area": area.id,
        "label": area.label,
        "confidence": area.confidence,
        "probabilities": area.probabilities,
    }


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
        raise UsageError(f"{name} is {value!r}: give a number of metres, such as {name}=1.5")
    return float(value)


def _extent(semantic_map: SemanticMap) -> str:
    points = [point for area in semantic_map.areas for point in area.trajectory]
    if not points:
        return ", which is empty"
    (x0, y0), (x1, y1) = (tuple(f(each) for each in zip(*points, strict=True)) for f in (min, max))
    return f": the robot was between ({x0:.1f}, {y0:.1f}) and ({x1:.1f}, {y1:.1f})"
