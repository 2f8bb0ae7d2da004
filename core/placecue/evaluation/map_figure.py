"""The picture of a semantic map: areas coloured by category over what the laser saw.

After figure 17 of Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place
classification, IJRR 29(2-3), 2010.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.pictures import save_picture
from placecue.evaluation.window import window_of
from placecue.evaluation.window import within as _within
from placecue.semantic_map import UNKNOWN, Node, SemanticMap

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Points = NDArray[np.float64]
Truth = Sequence[tuple[float, float, str]]

#: Okabe and Ito's palette, told apart by the colour-blind too; black is kept for gateways.
PALETTE = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442")
#: Shapes of nodes; the second is taken when the palette has been used up once, and so on.
SHAPES = ("o", "s", "^", "D", "v", "p", "X")
GREY = "#8A8A8A"

Style = tuple[str, str]


def draw_semantic_map(
    semantic_map: SemanticMap,
    path: str | Path,
    *,
    points: Points | None = None,
    classes: Sequence[str] | None = None,
    truth: Truth | None = None,
    title: str | None = None,
    size: int = 1600,
    voxel: float = 0.1,
) -> Path:
    """Draw a semantic map into a picture file.

    Parameters
    ----------
    semantic_map : SemanticMap
        What to draw; it may be empty.
    path : str or Path
        File to write, ``.png``, ``.svg`` or ``.pdf``. It appears whole or not at all.
    points : ndarray of float64, shape (k, 2), optional
        Laser end points or walls in the map's frame, m, for the background.
    classes : sequence of str, optional
        Categories for the legend; the map's own by default.
    truth : sequence of (x, y, label), optional
        True categories along the way (x, y in m), drawn as small dots.
    title : str, optional
        Heading of the picture.
    size : int
        Longer side of the picture, pixels. The other follows the shape of the map.
    voxel : float
        Side of the squares that hold a point, and are drawn grey, m; larger where a map has more
        of them than the picture has pixels.

    What lies absurdly far from nearly all the rest is not drawn but marked at the edge.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    UsageError
        If the suffix of ``path`` is not that of a picture.
    DataError
        If the file cannot be written.
    """
    # The figure is made without pyplot, so no window system or global state comes into it.
    from matplotlib.figure import Figure

    styles = category_styles(_names(semantic_map, classes, truth))
    background = cells(points, voxel)
    window = window_of(_everything(semantic_map, background, truth))
    outside = _outside(semantic_map, background, truth, window)
    background = background[_within(background, window)]
    truth = [each for each in truth or () if _within(np.array([each[:2]]), window)[0]]
    extent = _padded(window)
    voxel = max(voxel, float((window[1] - window[0]).max()) / size)
    background = cells(background, voxel)
    figure = Figure(figsize=_size(extent, size), dpi=100, layout="constrained")
    axes = figure.add_subplot()
    _draw_background(axes, background, voxel)
    _draw_truth(axes, truth or (), styles)
    _draw_graph(axes, semantic_map, styles)
    _draw_names(axes, semantic_map)
    _frame(axes, extent, semantic_map.frame, title)
    _mark_outside(axes, outside, window)
    _legend(figure, styles, gateways=any(node.gateway for node in semantic_map.nodes))
    return save_picture(figure, path)


def category_styles(names: Sequence[str]) -> dict[str, Style]:
    """Return a colour and a shape for each category; ``unknown`` is a grey disc.

    Parameters
    ----------
    names : sequence of str
        The categories, in order of the legend.

    Returns
    -------
    dict of str to (str, str)
        Colour (``#RRGGBB``) and matplotlib marker.
    """
    styles = {
        name: (PALETTE[i % len(PALETTE)], SHAPES[i // len(PALETTE) % len(SHAPES)])
        for i, name in enumerate(name for name in names if name != UNKNOWN)
    }
    return {**styles, UNKNOWN: (GREY, "o")}


def cells(points: Points | None, voxel: float) -> Points:
    """Return the centres of the squares of side ``voxel`` (m) that hold a point, shape (k, 2)."""
    if points is None or len(points) == 0:
        return np.empty((0, 2))
    finite = points[np.isfinite(points).all(axis=1)]
    return np.asarray(np.unique(np.round(finite / voxel), axis=0) * voxel)


def _names(
    semantic_map: SemanticMap, classes: Sequence[str] | None, truth: Truth | None
) -> list[str]:
    listed = list(semantic_map.classes if classes is None else classes)
    met = {area.label for area in semantic_map.areas} | {label for _, _, label in truth or ()}
    return listed + sorted(met.difference(listed))


def _everything(semantic_map: SemanticMap, background: Points, truth: Truth | None) -> Points:
    """Return all points that are to be drawn, m, shape (n, 2)."""
    return np.concatenate([background, *_places(semantic_map, truth)])


def _places(semantic_map: SemanticMap, truth: Truth | None) -> tuple[Points, Points]:
    """Return the nodes, and where there is a true category, m, each of shape (n, 2)."""
    nodes = [(node.x, node.y) for node in semantic_map.nodes]
    way = [(x, y) for x, y, _ in truth or ()]
    as_points = (np.asarray(part, dtype=np.float64).reshape(-1, 2) for part in (nodes, way))
    nodes_at, way_at = as_points
    return nodes_at, way_at


def _outside(
    semantic_map: SemanticMap, background: Points, truth: Truth | None, window: Points
) -> Points:
    """Return the points that the window leaves out, m: of the way, or else of the background."""
    way = np.concatenate(_places(semantic_map, truth))
    for points in (way, background):
        left_out = points[~_within(points, window)]
        if len(left_out):
            return left_out
    return np.empty((0, 2))


def _padded(window: Points) -> Points:
    margin = max(1.0, 0.03 * float((window[1] - window[0]).max()))
    return np.array([window[0] - margin, window[1] + margin])


def _size(extent: Points, size: int) -> tuple[float, float]:
    across, up = extent[1] - extent[0]
    inches = size / 100
    if up <= across:
        return inches, inches * max(float(up / across), 0.35)
    return inches * max(float(across / up), 0.5), inches


def _draw_background(axes: Axes, background: Points, voxel: float) -> None:
    if len(background) == 0:
        return
    columns, rows = np.round(background / voxel).astype(np.int64).T
    grid = np.zeros((int(np.ptp(rows)) + 1, int(np.ptp(columns)) + 1), dtype=np.uint8)
    grid[rows - rows.min(), columns - columns.min()] = 2
    left, right = columns.min() - 0.5, columns.max() + 0.5
    bottom, top = rows.min() - 0.5, rows.max() + 0.5
    sides = (left * voxel, right * voxel, bottom * voxel, top * voxel)
    axes.imshow(grid, cmap="Greys", vmin=0, vmax=5, origin="lower", extent=sides, zorder=1)


def _draw_truth(axes: Axes, truth: Truth, styles: Mapping[str, Style]) -> None:
    for name in sorted({label for _, _, label in truth}):
        way = np.array([(x, y) for x, y, label in truth if label == name])
        axes.plot(*way.T, "o", color=styles[name][0], markersize=2.5, alpha=0.6, zorder=2)


def _draw_graph(axes: Axes, semantic_map: SemanticMap, styles: Mapping[str, Style]) -> None:
    from matplotlib.collections import LineCollection

    at = {node.id: (node.x, node.y) for node in semantic_map.nodes}
    lines = [[at[a], at[b]] for a, b in semantic_map.edges]
    axes.add_collection(LineCollection(lines, colors="#4D4D4D", linewidths=0.9, zorder=3))
    label_of = {area.id: area.label for area in semantic_map.areas}
    places: dict[Style, list[tuple[float, float]]] = defaultdict(list)
    for node in semantic_map.nodes:
        if not node.gateway:
            places[styles[label_of[node.area]]].append((node.x, node.y))
    edge: dict[str, Any] = {"markeredgecolor": "black", "markeredgewidth": 0.5}
    for (colour, shape), where in places.items():
        axes.plot(*zip(*where, strict=True), shape, color=colour, markersize=8, zorder=4, **edge)
    gateways = np.array([(n.x, n.y) for n in semantic_map.nodes if n.gateway]).reshape(-1, 2)
    axes.plot(*gateways.T, "D", color="black", markersize=5, zorder=5)


def _draw_names(axes: Axes, semantic_map: SemanticMap, most: int = 60) -> None:
    """Write the name of each area at its middle node; of very many only the largest."""
    from matplotlib.patheffects import withStroke

    members: dict[int, list[Node]] = defaultdict(list)
    for node in semantic_map.nodes:
        if not node.gateway:
            members[node.area].append(node)
    named = [area for area in semantic_map.areas if members[area.id]]
    named.sort(key=lambda area: -len(members[area.id]))
    for area in named[:most]:
        node = _middle(members[area.id])
        axes.annotate(
            f"{area.label} {area.id}",
            (node.x, node.y),
            xytext=(7, 7),
            textcoords="offset points",
            fontsize=10,
            zorder=6,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )


def _middle(nodes: Sequence[Node]) -> Node:
    positions = np.array([(node.x, node.y) for node in nodes])
    return nodes[int(((positions - positions.mean(axis=0)) ** 2).sum(axis=1).argmin())]


def _frame(axes: Axes, extent: Points, frame: str, title: str | None) -> None:
    axes.set_facecolor("white")
    axes.set_aspect("equal")
    axes.set_xlim(extent[0, 0], extent[1, 0])
    axes.set_ylim(extent[0, 1], extent[1, 1])
    axes.set_xlabel(f"x in {frame} (m)", fontsize=13)
    axes.set_ylabel(f"y in {frame} (m)", fontsize=13)
    axes.tick_params(labelsize=11)
    if title:
        axes.set_title(title, fontsize=16)


def _mark_outside(axes: Axes, outside: Points, window: Points) -> None:
    """Mark at the edge where points lie that are not drawn, and say how far."""
    if len(outside) == 0:
        return
    at = np.clip(outside, window[0], window[1])
    axes.plot(*np.unique(at, axis=0).T, "x", color="#B00000", markersize=10, zorder=7)
    farthest = float(np.hypot(*(outside - at).T).max())
    axes.annotate(
        f"{len(outside)} outside, up to {farthest:.3g} m away",
        at[0],
        xytext=(8, -14),
        textcoords="offset points",
        color="#B00000",
        fontsize=10,
        zorder=7,
    )


def _legend(figure: Figure, styles: Mapping[str, Style], gateways: bool) -> None:
    from matplotlib.lines import Line2D

    marks: dict[str, Any] = {"linestyle": "none", "markeredgecolor": "black", "markersize": 9}
    handles = [
        Line2D([], [], color=colour, marker=shape, label=name, **marks)
        for name, (colour, shape) in styles.items()
    ]
    if gateways:
        marks["markersize"] = 6
        handles.append(Line2D([], [], color="black", marker="D", label="doorway passed", **marks))
    # A letter is about 0.11 inches wide at this size, mark and space about 0.6.
    widest = 0.11 * max(len(str(handle.get_label())) for handle in handles) + 0.6
    columns = min(len(handles), max(1, int(figure.get_figwidth() / widest)))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, fontsize=13)
