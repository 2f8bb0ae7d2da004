"""Poses, areas and the map."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np

from placecue.contracts.words import fields, number, whole
from placecue.errors import described
from placecue.observation import Pose2D
from placecue.semantic_map import Area, AreaUpdate, Node, SemanticMap


def area_update(made: Any) -> str | None:
    """Check what ``Accumulator.update`` returns."""
    if made is None:
        return None
    if not isinstance(made, AreaUpdate):
        return f"returned {described(made)}, not an AreaUpdate or None"
    return fields(
        "an AreaUpdate",
        ("area", made.area, whole(made.area), "a whole number"),
        ("label", made.label, isinstance(made.label, str), "a text"),
        ("confidence", made.confidence, number(made.confidence), "a finite number"),
        ("finished", made.finished, isinstance(made.finished, (bool, np.bool_)), "true or false"),
    )


def crossing(made: Any) -> str | None:
    """Check what ``Boundary.update`` returns."""
    if made is None:
        return None
    if not isinstance(made, Pose2D):
        return f"returned {described(made)}, not a Pose2D or None"
    return fields("a Pose2D", *_pose(made))


def behind(made: Any) -> str | None:
    """Check what ``Boundary.believe`` returns."""
    if made is None or (number(made) and made >= 0):
        return None
    told = f"{made!r}" if isinstance(made, Real) else described(made)
    return f"returned {told}, not a distance of at least 0 or None"


def semantic_map(made: Any) -> str | None:
    """Check what ``Accumulator.semantic_map`` returns, and that its parts refer to one another."""
    if not isinstance(made, SemanticMap):
        return f"returned {described(made)}, not a SemanticMap"
    for name, kind in (("areas", Area), ("nodes", Node)):
        for each in getattr(made, name):
            if not isinstance(each, kind):
                return f"returned a map with {described(each)} among its {name}"
    areas, nodes = {area.id for area in made.areas}, {node.id for node in made.nodes}
    lost = next((node for node in made.nodes if node.area not in areas), None)
    if lost is not None:
        return f"returned a map whose node {lost.id} is in area {lost.area}, which it has not"
    loose = next((edge for edge in made.edges if not nodes.issuperset(edge)), None)
    return None if loose is None else f"returned a map with an edge {loose} between no two nodes"


def pose(made: Any) -> str | None:
    """Check a pose; NaN is left to who uses it."""
    if not isinstance(made, Pose2D):
        return f"returned {described(made)}, not a Pose2D"
    numbers = ((name, getattr(made, name)) for name in ("x", "y", "theta"))
    return fields("a Pose2D", *((n, v, isinstance(v, Real), "a number") for n, v in numbers))


def _pose(made: Pose2D) -> Sequence[tuple[str, Any, bool, str]]:
    numbers = ((name, getattr(made, name)) for name in ("x", "y", "theta"))
    return [(name, value, number(value), "a finite number") for name, value in numbers]
