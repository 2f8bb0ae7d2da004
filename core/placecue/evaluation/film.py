"""A film strip: the map as it grew while the robot drove."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.belief import Belief
from placecue.evaluation.map_layers import draw_doors, draw_surfaces, draw_walls
from placecue.evaluation.map_legend import Shown, draw_legend
from placecue.evaluation.map_styles import Style, category_styles
from placecue.evaluation.pictures import save_picture
from placecue.free_space import OCCUPIED, FreeSpace, Grid
from placecue.observation import Observation
from placecue.semantic_map import SemanticMap
from placecue.surfaces import with_surfaces

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Still:
    """One picture of the strip.

    Parameters
    ----------
    seconds : float
        Since the first observation.
    semantic_map : SemanticMap
        As it stood, without surfaces.
    grid : Grid or None
        Free space as it was known.
    way : ndarray of float64, shape (n, 2)
        Where the robot had been, m; the last is where it was.
    """

    seconds: float
    semantic_map: SemanticMap
    grid: Grid | None
    way: NDArray[np.float64]


class Film:
    """Takes stills while a log of any length is labelled; a listener.

    Parameters
    ----------
    count : int
        How many stills the strip has.
    accumulator : Accumulator
        Whose map it is.
    space : FreeSpace
        A listener that is told before this one.

    Notes
    -----
    At most twice as many stills are held: where there are more, every other one goes, and from
    then on they are taken half as often.
    """

    def __init__(self, count: int, accumulator: Accumulator, space: FreeSpace) -> None:
        self.count = count
        self.accumulator = accumulator
        self.space = space
        self._stills: list[Still] = []
        self._every = 1
        self._seen = 0
        self._begin: int | None = None
        self._now = 0
        self._way: dict[tuple[int, int], tuple[float, float]] = {}

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Take in one moment, and every so often a still."""
        self._begin = observation.stamp if self._begin is None else self._begin
        self._now, pose = observation.stamp, observation.pose
        if pose is not None and pose.frame == self.space.frame:
            place = round(pose.x / self.space.cell), round(pose.y / self.space.cell)
            self._way.pop(place, None)  # it is the last one now
            self._way[place] = pose.x, pose.y
        self._seen += 1
        if self._seen % self._every == 0:
            self._stills.append(self._still())
        if len(self._stills) > 2 * self.count:
            self._stills = self._stills[1::2]
            self._every *= 2

    def stills(self) -> list[Still]:
        """Return the stills, evenly over the drive; the last shows its end."""
        if self._begin is None:
            return []
        found = [each for each in self._stills if each.seconds < self._seconds]
        wanted = self._seconds * np.arange(1, self.count) / self.count
        times = np.array([each.seconds for each in found])
        rows = {int(np.abs(times - each).argmin()) for each in wanted} if found else set()
        return [*(found[row] for row in sorted(rows)), self._still()]

    @property
    def _seconds(self) -> float:
        return (self._now - (self._begin or 0)) * 1e-9

    def _still(self) -> Still:
        way = np.array(list(self._way.values())).reshape(-1, 2)
        return Still(self._seconds, self.accumulator.semantic_map(), self.space.grid(), way)


def draw_film(stills: Sequence[Still], path: Path, classes: Sequence[str]) -> Path:
    """Draw stills side by side, all on one scale.

    Parameters
    ----------
    stills : sequence of Still
        One or more.
    path : Path
        The picture.
    classes : sequence of str
        All categories, by which colours are given out.
    """
    from matplotlib.figure import Figure

    last = stills[-1]
    low, high = _extent(last)
    across, up = (high - low).tolist()
    columns = len(stills) if up >= across else -(-len(stills) // 2)
    rows = -(-len(stills) // columns)
    width = 14 / columns
    height = rows * (width * up / across + 0.35) + 0.6
    figure = Figure(figsize=(14, height), dpi=100, layout="constrained")
    met = {area.label for still in stills for area in still.semantic_map.areas}
    every = category_styles([*classes, *sorted(met.difference(classes))])
    styles = {name: style for name, style in every.items() if name in met}
    for number, still in enumerate(stills, 1):
        axes = figure.add_subplot(rows, columns, number)
        _draw(axes, still, styles)
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
    doors = any(node.gateway for node in last.semantic_map.nodes)
    draw_legend(figure, styles, Shown(doors, last.grid is not None, False, False))
    return save_picture(figure, path)


def _draw(axes: Axes, still: Still, styles: dict[str, Style]) -> None:
    shown = with_surfaces(still.semantic_map, still.grid)
    draw_surfaces(axes, [area for area in shown.areas if area.frame == shown.frame], styles)
    if still.grid is not None:
        draw_walls(axes, _occupied(still.grid), still.grid.cell)
    draw_doors(axes, shown.nodes)
    axes.plot(*still.way.T, ".", color="black", markersize=1, zorder=6)
    axes.plot(*still.way[-1:].T, "o", color="#B00000", markersize=6, zorder=7)
    axes.set_aspect("equal")
    axes.set_title(f"{int(still.seconds) // 60}:{int(still.seconds) % 60:02d}", fontsize=11)
    axes.set_xticks([])
    axes.set_yticks([])


def _occupied(grid: Grid) -> NDArray[np.float64]:
    rows, columns = np.nonzero(grid.states == OCCUPIED)
    at = np.column_stack([columns, rows]) + 0.5
    return np.asarray(at * grid.cell + (grid.x, grid.y), dtype=np.float64)


def _extent(still: Still) -> NDArray[np.float64]:
    parts = [still.way] if still.grid is None else [still.way, _occupied(still.grid)]
    points = np.concatenate(parts) if sum(map(len, parts)) else np.zeros((1, 2))
    return np.asarray([points.min(axis=0) - 0.5, points.max(axis=0) + 0.5], dtype=np.float64)
