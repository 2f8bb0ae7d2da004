"""What the page in a browser shows, as JSON."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

import cv2
import numpy as np

from placecue.belief import Belief
from placecue.distribution import log_odds, softmax
from placecue.free_space import FREE, OCCUPIED, Grid
from placecue.scores import Scores
from placecue.semantic_map import Area, SemanticMap
from placecue.serving.onlooker import Moment

Told = dict[str, Any]
#: What cells look like in the picture of free space; the page gives them its colours.
GREYS = {FREE: 0, OCCUPIED: 255}
UNSEEN_GREY = 128


def moment_told(moment: Moment) -> Told:
    """Return what is said of one moment: where the robot is, what it believes, by which cue."""
    pose, belief, area = moment.observation.pose, moment.belief, moment.area
    here = pose is not None and all(map(isfinite, (pose.x, pose.y, pose.theta)))
    return {
        "stamp": moment.observation.stamp,
        "pose": [pose.x, pose.y, pose.theta] if here and pose is not None else None,
        "area": None
        if area is None
        else {"id": area.area, "label": area.label, "confidence": _number(area.confidence)},
        "belief": None if belief is None else _belief(belief),
    }


def map_told(semantic_map: SemanticMap, grid: Grid | None) -> Told:
    """Return the map with its surfaces, and the free space as a picture, m."""
    return {
        "frame": semantic_map.frame,
        "areas": [_area(area) for area in semantic_map.areas],
        "nodes": [[_round(n.x), _round(n.y), int(n.gateway)] for n in semantic_map.nodes],
        "space": None if grid is None else _space(grid),
    }


def _belief(belief: Belief) -> Told:
    cues = {name: _told(scores) for name, scores in belief.cue_scores.items()}
    return {
        "label": belief.label,
        **_told(belief.scores, belief.label),
        "cues": cues,
        "missing": list(belief.cues_missing),
    }


def _told(scores: Scores, label: str | None = None) -> Told:
    """Return the label that scores speak for, and how probable by them each class is."""
    shares = softmax(log_odds(scores.values, scores.layout))[0]
    classes = scores.layout.classes
    picked = str(scores.decide().labels[0])
    return {
        "label": picked if label is None else label,
        "confidence": _number(float(shares[list(classes).index(picked)])),
    }


def _area(area: Area) -> Told:
    return {
        "id": area.id,
        "label": area.label,
        "confidence": _number(area.confidence),
        "surface": [[_points(ring) for ring in polygon] for polygon in area.surface],
        "way": _points(area.trajectory),
    }


def _points(points: Sequence[tuple[float, float]]) -> list[list[float]]:
    return [[_round(x), _round(y)] for x, y in points]


def _space(grid: Grid) -> Told:
    greys: Mapping[Any, int] = GREYS
    picture = np.full(grid.states.shape, UNSEEN_GREY, np.uint8)
    for state, grey in greys.items():
        picture[grid.states == state] = grey
    _, data = cv2.imencode(".png", picture[::-1])  # pictures begin at the top
    return {
        "png": b64encode(data.tobytes()).decode("ascii"),
        "x": _round(grid.x),
        "y": _round(grid.y),
        "cell": grid.cell,
    }


def _round(value: float) -> float:
    return round(float(value), 2)


def _number(value: float) -> float | None:
    return round(value, 4) if isfinite(value) else None
