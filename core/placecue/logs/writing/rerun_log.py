"""A drive and its map as a recording of rerun (``.rrd``), through rerun's own SDK."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.accumulator import AreaUpdate
from placecue.atomic import replacing
from placecue.belief import Belief
from placecue.errors import UsageError
from placecue.logs.writing.scene import GREY, Color, palette
from placecue.observation import Observation, Pose2D
from placecue.semantic_map import SemanticMap

RECORDING = "labelled.rrd"
INSTALL = "pip install 'placecue[rerun]'"


def check_rerun() -> None:
    """Raise UsageError, with the line to type, unless rerun's SDK is installed."""
    if find_spec("rerun") is None:
        raise UsageError(
            f"viewer=rerun needs rerun-sdk, which is not installed: {INSTALL}, or leave it out"
        )


class RerunLog:
    """Writes pose, scan, beliefs and at last the map into a recording; a listener.

    Parameters
    ----------
    path : Path
        The file, ``.rrd``; it appears when the ``with`` block ends.
    classes : sequence of str
        Those of the model, for their colours.

    Notes
    -----
    In the tree: ``world/robot`` (pose), ``world/robot/scan``, ``world/beliefs`` (a dot in the
    colour of what is believed, at each observation), ``world/map/surfaces``, ``.../ways``,
    ``.../nodes``, ``.../doors`` and ``.../names``, static. Times are those of the log.
    """

    def __init__(self, path: Path, classes: Sequence[str]) -> None:
        check_rerun()
        self.path = path
        self.colours = palette(classes)
        self.rerun: Any = import_module("rerun")

    def __enter__(self) -> RerunLog:
        self._replacing = replacing(self.path)
        self.stream = self.rerun.RecordingStream("placecue")
        self.stream.save(self._replacing.__enter__())
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stream.disconnect()  # writes what is left
        self._replacing.__exit__(kind, error, trace)

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None
    ) -> None:
        """Write one moment."""
        rr, pose = self.rerun, observation.pose
        self.stream.set_time("log", timestamp=observation.stamp * 1e-9)
        if pose is not None:
            turn = rr.RotationAxisAngle(axis=[0, 0, 1], radians=pose.theta)
            at = rr.Transform3D(translation=[pose.x, pose.y, 0], rotation=turn)
            self.stream.log("world/robot", at, rr.Arrows3D(vectors=[[0.6, 0, 0]], radii=0.05))
        if observation.scan is not None:
            points = _flat(observation.scan.points())
            self.stream.log("world/robot/scan", rr.Points3D(points, radii=0.03))
        if belief is not None:
            self._believe(belief, pose)

    def _believe(self, belief: Belief, pose: Pose2D | None) -> None:
        rr = self.rerun
        told = f"{belief.label} {belief.confidence:.3f}"
        self.stream.log("belief", rr.TextLog(told))
        self.stream.log("belief/confidence", rr.Scalars(belief.confidence))
        if pose is not None:
            colour = self.colours.get(belief.label, GREY)
            dot = rr.Points3D([[pose.x, pose.y, 0.02]], radii=0.06, colors=[_bytes(colour)])
            self.stream.log("world/beliefs", dot)

    def close_with(self, semantic_map: SemanticMap) -> None:
        """Write the finished map, for all times."""
        rr, areas = self.rerun, semantic_map.areas
        areas = tuple(area for area in areas if area.frame == semantic_map.frame)
        colour = {area.id: _bytes(self.colours.get(area.label, GREY)) for area in areas}
        rings = [(area.id, ring) for area in areas for each in area.surface for ring in each]
        outlines = [_flat(np.array([*ring, ring[0]])) for _, ring in rings]
        tints = [colour[number] for number, _ in rings]
        lines = rr.LineStrips3D(outlines, colors=tints, radii=0.04)
        self.stream.log("world/map/surfaces", lines, static=True)
        nodes = [n for n in semantic_map.nodes if n.area in colour]
        for name, gateway, radius in (("nodes", False, 0.15), ("doors", True, 0.25)):
            chosen = [n for n in nodes if n.gateway == gateway]
            at = _flat(np.array([(n.x, n.y) for n in chosen]).reshape(-1, 2))
            shown = rr.Points3D(at, radii=radius, colors=[colour[n.area] for n in chosen])
            self.stream.log(f"world/map/{name}", shown, static=True)
        where = {n.id: (n.x, n.y, 0.0) for n in nodes}
        ways = [[where[a], where[b]] for a, b in semantic_map.edges if a in where and b in where]
        self.stream.log("world/map/ways", rr.LineStrips3D(ways, radii=0.02), static=True)
        named = [(a, np.mean(a.trajectory, axis=0)) for a in areas if a.trajectory]
        names = rr.Points3D(
            _flat(np.array([at for _, at in named]).reshape(-1, 2)),
            radii=0.02,
            labels=[f"{a.label} {a.id}: {100 * a.confidence:.0f} %" for a, _ in named],
            show_labels=True,
        )
        self.stream.log("world/map/names", names, static=True)


def _flat(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points on the ground, shape (n, 3), m."""
    return np.column_stack([points, np.zeros(len(points))])


def _bytes(colour: Color) -> tuple[int, ...]:
    return tuple(round(255 * part) for part in colour)
