"""The layers of a map picture: surfaces, walls, way, graph and doors, from below upwards."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.map_styles import GREY, HATCH, Style, shade
from placecue.polygons import Polygon
from placecue.semantic_map import UNKNOWN, Area, Node, SemanticMap

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.path import Path

Points = NDArray[np.float64]
#: Positions, m, with a label each.
Labelled = Sequence[tuple[float, float, str]]

#: From the middle of a drawn door to its posts, m.
DOOR_HALF_WIDTH = 0.45
WALL = "#3C3C3C"
FILLS, WALLS, EDGES, TRUTH, BELIEFS, NODES, DOORS, TEXTS = range(1, 9)


def draw_surfaces(axes: Axes, areas: Sequence[Area], styles: Mapping[str, Style]) -> None:
    """Fill each area, paler the less sure; one without a surface is a broad way."""
    from matplotlib.patches import PathPatch

    for area in areas:
        colour, unknown = styles[area.label][0], area.label == UNKNOWN
        face = shade(colour, 0.0 if unknown else area.confidence)
        if area.surface:
            hatch: dict[str, Any] = {"hatch": HATCH, "edgecolor": "#B5B5B5"} if unknown else {}
            shown = {"facecolor": face, "edgecolor": colour, "linewidth": 0.8, "zorder": FILLS}
            axes.add_patch(PathPatch(_outline(area.surface), **{**shown, **hatch}))
        elif area.trajectory:
            axes.plot(*zip(*area.trajectory, strict=True), "o", color=face, ms=10, zorder=FILLS)


def _outline(surface: Sequence[Polygon]) -> Path:
    from matplotlib.path import Path

    rings = [np.array([*ring, ring[0]]) for polygon in surface for ring in polygon]
    return Path.make_compound_path(*(Path(ring, closed=True) for ring in rings))


def draw_walls(axes: Axes, points: Points, voxel: float) -> None:
    """Draw the squares (side ``voxel``, m) around some centres; nothing hides what is free."""
    from matplotlib.colors import ListedColormap

    if len(points) == 0:
        return
    columns, rows = np.round(points / voxel).astype(np.int64).T
    grid = np.zeros((int(np.ptp(rows)) + 1, int(np.ptp(columns)) + 1), dtype=np.uint8)
    grid[rows - rows.min(), columns - columns.min()] = 1
    left, right = columns.min() - 0.5, columns.max() + 0.5
    bottom, top = rows.min() - 0.5, rows.max() + 0.5
    sides = (left * voxel, right * voxel, bottom * voxel, top * voxel)
    colours = ListedColormap(["none", WALL])
    drawn: dict[str, Any] = {"cmap": colours, "vmin": 0, "vmax": 1, "interpolation": "nearest"}
    axes.imshow(grid, origin="lower", extent=sides, zorder=WALLS, **drawn)


def draw_way(
    axes: Axes, way: Labelled, styles: Mapping[str, Style], size: float, zorder: int
) -> None:
    """Draw positions as dots (diameter in points) in the colours of their labels."""
    by_label: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for x, y, label in way:
        by_label[label].append((x, y))
    for label in sorted(by_label):
        marks: dict[str, Any] = {"color": styles[label][0], "markeredgewidth": 0, "ms": size}
        axes.plot(*zip(*by_label[label], strict=True), "o", zorder=zorder, **marks)


def draw_graph(axes: Axes, semantic_map: SemanticMap, styles: Mapping[str, Style]) -> None:
    """Draw nodes, in shape and colour of their area's label, and edges."""
    from matplotlib.collections import LineCollection

    at = {node.id: (node.x, node.y) for node in semantic_map.nodes}
    lines = [[at[a], at[b]] for a, b in semantic_map.edges if a in at and b in at]
    axes.add_collection(LineCollection(lines, colors="#6E6E6E", linewidths=0.6, zorder=EDGES))
    label_of = {area.id: area.label for area in semantic_map.areas}
    places: dict[Style, list[Node]] = defaultdict(list)
    for node in semantic_map.nodes:
        if not node.gateway:
            places[styles[label_of[node.area]]].append(node)
    for (colour, shape), nodes in places.items():
        marks: dict[str, Any] = {"markeredgecolor": "black", "markeredgewidth": 0.5, "ms": 5}
        xs, ys = [n.x for n in nodes], [n.y for n in nodes]
        axes.plot(xs, ys, shape, color=colour, zorder=NODES, **marks)


def draw_doors(axes: Axes, nodes: Sequence[Node]) -> None:
    """Draw each door as a line across the direction that it was passed in."""
    from matplotlib.collections import LineCollection

    lines = []
    for node in nodes:
        if node.gateway:
            across = DOOR_HALF_WIDTH * np.array([-np.sin(node.heading), np.cos(node.heading)])
            middle = np.array([node.x, node.y])
            lines.append([middle + across, middle - across])
    drawn: dict[str, Any] = {"linewidths": 3.5, "capstyle": "butt", "zorder": DOORS}
    axes.add_collection(LineCollection(lines, colors="black", **drawn))


def unknown_colour() -> str:
    """Return what unknown areas are filled with, under the hatching."""
    return shade(GREY, 0.0)
