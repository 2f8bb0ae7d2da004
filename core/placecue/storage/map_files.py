"""A semantic map for others: Nav2's route graph and occupancy grid, and a table of nodes."""

from __future__ import annotations

import csv
import io
import logging
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np

from placecue.atomic import replacing, write_json, write_text
from placecue.free_space import FREE, OCCUPIED, Grid
from placecue.semantic_map import SemanticMap

log = logging.getLogger(__name__)

ROUTE_GRAPH, PICTURE, ABOUT, NODES = "route_graph.geojson", "map.pgm", "map.yaml", "nodes.csv"

#: Columns of the table of nodes that say how sure a position is; empty where nothing tells.
SIGMAS = ("sigma_x_m", "sigma_y_m", "sigma_heading_rad")

#: Grey levels of a picture that Nav2's map server reads in its mode "trinary".
WHITE, BLACK, GREY = 254, 0, 205


def write_map_files(semantic_map: SemanticMap, grid: Grid | None, folder: Path) -> list[Path]:
    """Write what Nav2 reads, and a table of the nodes.

    Parameters
    ----------
    semantic_map : SemanticMap
        The map.
    grid : Grid or None
        Free space; None writes no picture.
    folder : Path
        Where.

    Returns
    -------
    list of Path
        The files.
    """
    if not semantic_map.edges:
        log.warning(
            f"{folder / ROUTE_GRAPH} has no edges, as the robot went nowhere: Nav2's route server "
            "refuses such a graph"
        )
    written = [
        write_json(folder / ROUTE_GRAPH, route_graph(semantic_map)),
        write_text(folder / NODES, node_table(semantic_map)),
    ]
    if grid is not None:
        written += _write_grid(grid, folder)
    return written


def route_graph(semantic_map: SemanticMap) -> dict[str, Any]:
    """Return the navigation graph as Nav2's route server reads it.

    The class of a node is in its metadata, where the server's SemanticScorer looks for it by
    default (``semantic_key: class``). Each edge is there in both directions. Nodes of another
    frame than the map's are left out.

    References
    ----------
    https://docs.nav2.org/tutorials/docs/route_server_tools/route_graph_generation.html
    """
    areas = {area.id: area for area in semantic_map.areas}
    nodes = {
        node.id: node for node in semantic_map.nodes if areas[node.area].frame == semantic_map.frame
    }
    features = [
        {
            "type": "Feature",
            "properties": {
                "id": node.id,
                "frame": semantic_map.frame,
                "metadata": {
                    "class": areas[node.area].label,
                    "confidence": areas[node.area].confidence,
                    "area": node.area,
                    "gateway": node.gateway,
                },
            },
            "geometry": {"type": "Point", "coordinates": [node.x, node.y]},
        }
        for node in nodes.values()
    ]
    both = [way for a, b in semantic_map.edges for way in ((a, b), (b, a))]
    for number, (a, b) in enumerate(both, max(nodes, default=-1) + 1):
        if a in nodes and b in nodes:
            ends = [[nodes[n].x, nodes[n].y] for n in (a, b)]
            length = hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1])
            features.append(
                {
                    "type": "Feature",
                    "properties": {"id": number, "startid": a, "endid": b, "cost": length},
                    "geometry": {"type": "MultiLineString", "coordinates": [ends]},
                }
            )
    return {"type": "FeatureCollection", "name": "placecue", "features": features}


def node_table(semantic_map: SemanticMap) -> str:
    """Return a CSV table, a line a node: where it is, its area, and how probable each class is."""
    areas = {area.id: area for area in semantic_map.areas}
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    head = ("node", "x_m", "y_m", "frame", "area", "gateway", "label", "confidence", *SIGMAS)
    writer.writerow([*head, *(f"p({name})" for name in semantic_map.classes)])
    for node in semantic_map.nodes:
        area = areas[node.area]
        about = (node.id, f"{node.x:.4f}", f"{node.y:.4f}", area.frame, area.id, int(node.gateway))
        shares = (node.probabilities.get(name) for name in semantic_map.classes)
        told = ("" if share is None else f"{share:.4f}" for share in shares)
        sure = [f"{sigma:.4f}" for sigma in node.uncertainty] if node.uncertainty else [""] * 3
        writer.writerow([*about, area.label, f"{area.confidence:.4f}", *sure, *told])
    return table.getvalue()


def _write_grid(grid: Grid, folder: Path) -> list[Path]:
    levels = np.where(grid.states == FREE, WHITE, np.where(grid.states == OCCUPIED, BLACK, GREY))
    rows, columns = levels.shape
    with replacing(folder / PICTURE) as part:
        head = f"P5\n{columns} {rows}\n255\n".encode()
        part.write_bytes(head + levels[::-1].astype(np.uint8).tobytes())  # the top line first
    about = (
        f"image: {PICTURE}\nmode: trinary\nresolution: {grid.cell:g}\n"
        f"origin: [{grid.x:.6f}, {grid.y:.6f}, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"  # just below the grey of what is unseen
    )
    return [folder / PICTURE, write_text(folder / ABOUT, about)]
