"""Labelled areas and the navigation graph that they lie on."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from math import hypot
from typing import Any

from placecue.errors import DataError
from placecue.map_geojson import geojson_of
from placecue.polygons import Polygon, area_of, holds

#: The label of a belief that was not sure enough, and of an area that none was sure enough of.
UNKNOWN = "unknown"

#: Of the format that :meth:`SemanticMap.to_json` gives.
VERSION = 2


@dataclass(frozen=True, slots=True)
class Node:
    """A place that the robot has been at.

    Parameters
    ----------
    id : int
        Number of the node.
    x, y : float
        Position, m.
    area : int
        The area that the node belongs to.
    gateway : bool
        Whether the node is a door.
    heading : float
        The direction in which the door is passed, rad; 0 for other nodes.
    probabilities : dict of str to float
        Of each class by what was seen at the node alone; empty where nothing was.
    uncertainty : tuple of float or None
        Standard deviations of x, y (m) and heading (rad) of the robot there, where poses were
        corrected by scans.
    """

    id: int
    x: float
    y: float
    area: int
    gateway: bool = False
    heading: float = 0.0
    probabilities: dict[str, float] = field(default_factory=dict)
    uncertainty: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Area:
    """A part of space between boundaries, with one label.

    Parameters
    ----------
    id : int
        Number of the area.
    label : str
        The class, or ``unknown``.
    confidence : float
        The probability that the label is right; 0 where unknown.
    scores : dict of str to float
        Accumulated score by column of the layout.
    start, end : int
        Stamps of the first and last observation, ns.
    trajectory : tuple of (float, float)
        Positions that the robot passed, m, thinned to one a bin.
    margin : float
        Confidence of the accumulated belief in the unit of the scores; 0 where unknown.
    probabilities : dict of str to float
        Of each class; empty where nothing was seen.
    frame : str
        The frame that its positions are given in.
    surface : tuple of polygons
        The free space that belongs to it, m: each polygon an outline and holes in it. Empty where
        none was shared out.
    """

    id: int
    label: str
    confidence: float
    scores: dict[str, float] = field(default_factory=dict)
    start: int = 0
    end: int = 0
    trajectory: tuple[tuple[float, float], ...] = ()
    margin: float = 0.0
    probabilities: dict[str, float] = field(default_factory=dict)
    frame: str = "odom"
    surface: tuple[Polygon, ...] = ()

    @property
    def size(self) -> float:
        """The area of its surface, m²."""
        return sum(area_of(ring) for polygon in self.surface for ring in polygon)


@dataclass(frozen=True, slots=True)
class AreaUpdate:
    """What an accumulator says after an observation that changed its mind.

    Parameters
    ----------
    area : int
        Number of the area.
    label : str
        Its class as of now, or ``unknown``.
    confidence : float
        The probability that the label is right; 0 where unknown.
    finished : bool
        Whether the robot has left the area.
    """

    area: int
    label: str
    confidence: float
    finished: bool = False


@dataclass(frozen=True, slots=True)
class SemanticMap:
    """Areas with labels, nodes on which the robot was, and edges between the nodes.

    Parameters
    ----------
    areas : tuple of Area
    nodes : tuple of Node
    edges : tuple of (int, int)
        Pairs of node ids, the smaller first.
    classes : tuple of str
        The classes that labels come from.
    frame : str
        The frame that positions are given in.
    """

    areas: tuple[Area, ...]
    nodes: tuple[Node, ...]
    edges: tuple[tuple[int, int], ...]
    classes: tuple[str, ...]
    frame: str = "odom"

    def area(self, number: int) -> Area:
        """Return the area of the given id.

        Raises
        ------
        DataError
            If there is no such area.
        """
        for area in self.areas:
            if area.id == number:
                return area
        raise DataError(f"the map has no area {number}; it has {len(self.areas)} areas")

    def at(self, x: float, y: float, within: float = 1.0) -> Area | None:
        """Return the area that a position lies in, in the map's frame.

        Parameters
        ----------
        x, y : float
            Position, m.
        within : float
            Where it lies on no surface, the area whose way passes nearest counts, up to so far, m.

        Returns
        -------
        Area or None
            Its ``confidence`` is the probability of its label, ``probabilities`` those of all
            classes; None where the map does not reach.
        """
        here = [area for area in self.areas if area.frame == self.frame]
        for area in here:
            if holds(area.surface, x, y):
                return area
        nearest, best = None, within
        for area in here:
            for px, py in area.trajectory:
                if (distance := hypot(px - x, py - y)) <= best:
                    nearest, best = area, distance
        return nearest

    def to_json(self) -> dict[str, Any]:
        """Return the map as plain data."""
        return {
            "type": "placecue/semantic_map",
            "version": VERSION,
            "frame": self.frame,
            "classes": list(self.classes),
            "areas": [asdict(area) for area in self.areas],
            "nodes": [asdict(node) for node in self.nodes],
            "edges": [list(edge) for edge in self.edges],
        }

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> SemanticMap:
        """Read back what :meth:`to_json` gave.

        Raises
        ------
        DataError
            If the data are not a semantic map of a known version, or lack something.
        """
        if data.get("type") != "placecue/semantic_map" or data.get("version") != VERSION:
            raise DataError(
                f"not a semantic map: expected type 'placecue/semantic_map' of version {VERSION}, "
                f"got {data.get('type')!r} of version {data.get('version')!r}"
            )
        try:
            return cls(
                areas=tuple(_area(area) for area in data["areas"]),
                nodes=tuple(_node(node) for node in data["nodes"]),
                edges=tuple((a, b) for a, b in data["edges"]),
                classes=tuple(data["classes"]),
                frame=data["frame"],
            )
        except (KeyError, TypeError, ValueError) as error:
            raise DataError(
                f"broken semantic map ({type(error).__name__}: {error}): make it again with "
                "'placecue label'"
            ) from error

    def to_geojson(self) -> dict[str, Any]:
        """Return areas, nodes and edges as GeoJSON; see :func:`placecue.map_geojson.geojson_of`."""
        return geojson_of(self)


def _node(data: dict[str, Any]) -> Node:
    found = data.get("uncertainty")
    return Node(**{**data, "uncertainty": None if found is None else (*map(float, found),)})


def _area(data: dict[str, Any]) -> Area:
    surface = tuple(
        tuple(tuple((x, y) for x, y in ring) for ring in polygon) for polygon in data["surface"]
    )
    trajectory = tuple((x, y) for x, y in data["trajectory"])
    return Area(**{**data, "trajectory": trajectory, "surface": surface})
