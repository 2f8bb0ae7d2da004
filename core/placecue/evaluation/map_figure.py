"""The picture of a semantic map: areas filled by category, over walls, way, graph and doors.

After figure 17 of Pronobis, Martinez Mozos, Caputo, Jensfelt, Multi-modal semantic place
classification, IJRR 29(2-3), 2010.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from placecue.evaluation.captions import captions
from placecue.evaluation.map_layers import (
    BELIEFS,
    TEXTS,
    TRUTH,
    Labelled,
    Points,
    draw_doors,
    draw_graph,
    draw_surfaces,
    draw_walls,
    draw_way,
)
from placecue.evaluation.map_legend import Shown, draw_legend
from placecue.evaluation.map_styles import Style, category_styles
from placecue.evaluation.pictures import boxes_for_unknown, save_picture
from placecue.evaluation.scale_bar import draw_scale_bar
from placecue.evaluation.text_sizes import TextSizes
from placecue.evaluation.window import window_of, within
from placecue.semantic_map import SemanticMap

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NOTHING = np.empty((0, 2))


def draw_semantic_map(
    semantic_map: SemanticMap,
    path: str | Path,
    *,
    points: Points | None = None,
    classes: Sequence[str] | None = None,
    beliefs: Labelled = (),
    truth: Labelled = (),
    title: str | None = None,
    about: str | None = None,
    size: int = 1600,
    voxel: float = 0.1,
) -> Path:
    """Draw a semantic map into a picture file.

    Parameters
    ----------
    semantic_map : SemanticMap
        What to draw; it may be empty. Areas of another frame than the map's are not drawn, and
        counted in the heading.
    path : str or Path
        File to write, ``.png``, ``.svg`` or ``.pdf``. It appears whole or not at all.
    points : ndarray of float64, shape (k, 2), optional
        Laser end points or walls in the map's frame, m.
    classes : sequence of str, optional
        All categories, by which colours are given out; the map's own by default.
    beliefs : sequence of (x, y, label)
        What was believed along the way (x, y in m), drawn as thin dots.
    truth : sequence of (x, y, label)
        True categories along the way, drawn as dots, below and around those of beliefs.
    title, about : str, optional
        Heading of the picture, and a smaller line below it.
    size : int
        Longer side of the picture, pixels. The other follows the shape of the map.
    voxel : float
        Side of the squares that hold a point, m; larger where a map has more of them than the
        picture has pixels.

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
    figure = map_figure(
        semantic_map,
        points=points,
        classes=classes,
        beliefs=beliefs,
        truth=truth,
        title=title,
        about=about,
        size=size,
        voxel=voxel,
    )
    return save_picture(figure, path)


def map_figure(
    semantic_map: SemanticMap,
    *,
    points: Points | None = None,
    classes: Sequence[str] | None = None,
    beliefs: Labelled = (),
    truth: Labelled = (),
    title: str | None = None,
    about: str | None = None,
    size: int = 1600,
    voxel: float = 0.1,
) -> Figure:
    """Return the figure that :func:`draw_semantic_map` writes; parameters are its."""
    # The figure is made without pyplot, so no window system or global state comes into it.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    listed = semantic_map.classes if classes is None else classes
    elsewhere = len(semantic_map.areas)
    semantic_map = _in_one_frame(semantic_map)
    elsewhere -= len(semantic_map.areas)
    way = [*beliefs, *truth]
    styles = _styles(listed, semantic_map, way)
    walls = cells(points, voxel)
    places = np.concatenate(_places(semantic_map, way))
    # What the laser saw through far windows is no part of the map where there are surfaces.
    surfaces = any(area.surface for area in semantic_map.areas)
    window = window_of(places if surfaces else np.concatenate([walls, places]))
    outside = _outside(places, NOTHING if surfaces else walls, window)
    voxel = max(voxel, float((window[1] - window[0]).max()) / size)
    extent = _padded(window)
    walls = cells(walls[within(walls, extent)], voxel)
    figure = Figure(figsize=_size(extent, size), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    draw_surfaces(axes, semantic_map.areas, styles)
    draw_walls(axes, walls, voxel)
    draw_graph(axes, semantic_map, styles)
    draw_way(axes, _inside(truth, window), styles, 4.0 if beliefs else 2.5, TRUTH)
    draw_way(axes, _inside(beliefs, window), styles, 1.8, BELIEFS)
    draw_doors(axes, semantic_map.nodes)
    _frame(axes, extent, semantic_map.frame)
    _head(axes, title, [about, _elsewhere(elsewhere, semantic_map.frame)])
    _mark_outside(axes, outside, window)
    draw_scale_bar(axes, extent)
    doors = any(node.gateway for node in semantic_map.nodes)
    shown = Shown(doors, len(walls) > 0, len(beliefs) > 0, len(truth) > 0)
    draw_legend(figure, styles, shown)
    _caption(figure, axes, semantic_map, extent)
    return figure


def cells(points: Points | None, voxel: float) -> Points:
    """Return the centres of the squares of side ``voxel`` (m) that hold a point, shape (k, 2)."""
    if points is None or len(points) == 0:
        return NOTHING
    finite = points[np.isfinite(points).all(axis=1)]
    return np.asarray(np.unique(np.round(finite / voxel), axis=0) * voxel)


def _in_one_frame(semantic_map: SemanticMap) -> SemanticMap:
    areas = tuple(area for area in semantic_map.areas if area.frame == semantic_map.frame)
    kept = {area.id for area in areas}
    nodes = tuple(node for node in semantic_map.nodes if node.area in kept)
    return replace(semantic_map, areas=areas, nodes=nodes)


def _elsewhere(count: int, frame: str) -> str | None:
    return f"{count} areas in other frames than '{frame}' are not drawn" if count else None


def _styles(listed: Sequence[str], semantic_map: SemanticMap, way: Labelled) -> dict[str, Style]:
    """Return the styles of what is there, in the order of all categories."""
    met = {area.label for area in semantic_map.areas} | {label for _, _, label in way}
    every = category_styles([*listed, *sorted(met.difference(listed))])
    return {name: style for name, style in every.items() if name in met}


def _places(semantic_map: SemanticMap, way: Labelled) -> tuple[Points, ...]:
    """Return the nodes, the way, and the corners of surfaces, m, each of shape (n, 2)."""
    nodes = [(node.x, node.y) for node in semantic_map.nodes]
    at = [(x, y) for x, y, _ in way]
    corners = [c for area in semantic_map.areas for outline, *_ in area.surface for c in outline]
    parts = (nodes, at, corners)
    return tuple(np.asarray(part, dtype=np.float64).reshape(-1, 2) for part in parts)


def _outside(places: Points, walls: Points, window: Points) -> Points:
    """Return the points that the window leaves out, m: of the map, or else of the walls."""
    for points in (places, walls):
        left_out = points[~within(points, window)]
        if len(left_out):
            return left_out
    return NOTHING


def _inside(way: Labelled, window: Points) -> Labelled:
    kept = within(np.array([(x, y) for x, y, _ in way]).reshape(-1, 2), window)
    return [each for each, inside in zip(way, kept.tolist(), strict=True) if inside]


def _padded(window: Points) -> Points:
    """Return a window with a margin, m; more below, where the scale bar stands."""
    margin = max(1.0, 0.03 * float((window[1] - window[0]).max()))
    return np.array([window[0] - (margin, 1.5 * margin), window[1] + margin])


def _size(extent: Points, size: int) -> tuple[float, float]:
    across, up = extent[1] - extent[0]
    inches = size / 100
    if up <= across:
        return inches, inches * max(float(up / across), 0.35)
    return inches * max(float(across / up), 0.5), inches


def _frame(axes: Axes, extent: Points, frame: str) -> None:
    axes.set_facecolor("white")
    axes.set_aspect("equal")
    axes.set_xlim(extent[0, 0], extent[1, 0])
    axes.set_ylim(extent[0, 1], extent[1, 1])
    axes.set_xlabel(f"x in {frame} (m)", fontsize=12)
    axes.set_ylabel(f"y in {frame} (m)", fontsize=12)
    axes.tick_params(labelsize=11)


def _head(axes: Axes, title: str | None, lines: Sequence[str | None]) -> None:
    told = "\n".join(line for line in lines if line)
    if told:
        axes.set_title(told, fontsize=11, color="#4D4D4D", parse_math=False)
    if title and axes.figure is not None:
        axes.figure.suptitle(title, fontsize=16, parse_math=False)


def _caption(figure: Figure, axes: Axes, semantic_map: SemanticMap, extent: Points) -> None:
    """Write captions, once all else has its place: from then on a metre has its length."""
    from matplotlib.patheffects import withStroke

    with boxes_for_unknown():
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    (left, _), (right, _) = axes.transData.transform([(0.0, 0.0), (1.0, 0.0)])
    for each in captions(semantic_map.areas, extent, TextSizes(figure, right - left)):
        axes.text(
            each.x,
            each.y,
            each.text,
            fontsize=each.size,
            rotation=90 if each.upright else 0,
            ha="center",
            va="center",
            gid=f"caption-{each.area}",
            parse_math=False,
            zorder=TEXTS,
            path_effects=[withStroke(linewidth=2, foreground="white")],
        )


def _mark_outside(axes: Axes, outside: Points, window: Points) -> None:
    """Mark at the edge where points lie that are not drawn, and say how far."""
    if len(outside) == 0:
        return
    at = np.clip(outside, window[0], window[1])
    axes.plot(*np.unique(at, axis=0).T, "x", color="#B00000", markersize=10, zorder=TEXTS)
    farthest = float(np.hypot(*(outside - at).T).max())
    axes.annotate(
        f"{len(outside)} outside, up to {farthest:.3g} m away",
        at[0],
        xytext=(8, -14),
        textcoords="offset points",
        color="#B00000",
        fontsize=10,
        zorder=TEXTS,
    )
