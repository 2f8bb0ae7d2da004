"""A semantic map as GeoJSON: for viewers and GIS, and to be given back as rooms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from placecue.polygons import Ring
    from placecue.semantic_map import Area, SemanticMap


def geojson_of(semantic_map: SemanticMap) -> dict[str, Any]:
    """Return areas, nodes and edges of a map, metres as coordinates.

    Areas are polygons where they have a surface, otherwise lines along the robot's way. Areas
    with a label carry it as ``class``, so that the file can be given as rooms. Ids are unique;
    the frame and the unit stand beside the features.
    """
    label_of = {area.id: area.label for area in semantic_map.areas}
    at = {node.id: (node.x, node.y) for node in semantic_map.nodes}
    nodes_of: dict[int, list[int]] = {area.id: [] for area in semantic_map.areas}
    for node in semantic_map.nodes:
        nodes_of[node.area].append(node.id)
    features = [_area(area, nodes_of[area.id]) for area in semantic_map.areas]
    features += [
        _feature(
            f"node-{node.id}",
            ("Point", [node.x, node.y]),
            {
                "kind": "node",
                "number": node.id,
                "area": node.area,
                "gateway": node.gateway,
                "label": label_of[node.area],
                "probabilities": node.probabilities,
            },
        )
        for node in semantic_map.nodes
    ]
    features += [
        _feature(
            f"edge-{a}-{b}",
            ("LineString", [list(at[a]), list(at[b])]),
            {"kind": "edge", "nodes": [a, b]},
        )
        for a, b in semantic_map.edges
    ]
    return {
        "type": "FeatureCollection",
        "frame": semantic_map.frame,
        "units": "m",
        "features": features,
    }


def _area(area: Area, nodes: Sequence[int]) -> dict[str, Any]:
    properties = {
        "kind": "area",
        "number": area.id,
        "class": "" if area.confidence == 0 else area.label,  # what is unknown is no room
        "label": area.label,
        "confidence": area.confidence,
        "probabilities": area.probabilities,
        "frame": area.frame,
        "square_metres": round(area.size, 3),
        "nodes": list(nodes),
    }
    return _feature(f"area-{area.id}", _geometry(area), properties)


def _geometry(area: Area) -> tuple[str, Any]:
    polygons = [[_closed(ring) for ring in polygon] for polygon in area.surface]
    if polygons:
        return ("Polygon", polygons[0]) if len(polygons) == 1 else ("MultiPolygon", polygons)
    way = [list(point) for point in area.trajectory]
    return "MultiPoint" if len(way) < 2 else "LineString", way


def _closed(ring: Ring) -> list[list[float]]:
    return [list(point) for point in (*ring, ring[0])]


def _feature(name: str, geometry: tuple[str, Any], properties: dict[str, Any]) -> dict[str, Any]:
    shape, coordinates = geometry
    return {
        "type": "Feature",
        "id": name,
        "geometry": {"type": shape, "coordinates": coordinates},
        "properties": properties,
    }
