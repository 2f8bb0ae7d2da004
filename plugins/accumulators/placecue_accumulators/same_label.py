"""Neighbouring areas of one category joined into one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from placecue.semantic_map import UNKNOWN, Area, SemanticMap

Merge = Literal["none", "open", "all"]
MERGES: tuple[Merge, ...] = get_args(Merge)


def merge_same_label(semantic_map: SemanticMap, merge: Merge = "all") -> SemanticMap:
    """Join areas that an edge of the graph connects and that have the same label.

    A false boundary only cuts an area in two; this undoes it. Unknown areas are left alone.

    Parameters
    ----------
    semantic_map : SemanticMap
        A map; it is not changed.
    merge : {"none", "open", "all"}
        Whether to join nothing, areas without a door between them, or those with one too.

    Returns
    -------
    SemanticMap
        The map with the joined areas under their smallest number. Scores, margins and
        probabilities are averaged, weighted by the positions in each area's trajectory.
    """
    if merge == "none":
        return semantic_map
    groups = _groups(semantic_map, doors=merge == "all")
    joined = {area.id: group[0].id for group in groups for area in group}
    return replace(
        semantic_map,
        areas=tuple(_join(group) for group in groups),
        nodes=tuple(replace(node, area=joined[node.area]) for node in semantic_map.nodes),
    )


def _groups(semantic_map: SemanticMap, doors: bool) -> list[list[Area]]:
    areas = sorted(semantic_map.areas, key=lambda area: area.id)
    row = {area.id: i for i, area in enumerate(areas)}
    home = {node.id: row[node.area] for node in semantic_map.nodes}
    closed = set() if doors else {node.id for node in semantic_map.nodes if node.gateway}
    edges = [edge for edge in semantic_map.edges if closed.isdisjoint(edge)]
    pairs = [(home[a], home[b]) for a, b in edges]
    alike = [(a, b) for a, b in pairs if areas[a].label == areas[b].label != UNKNOWN]
    first, second = np.array(alike, dtype=np.intp).reshape(-1, 2).T
    links = coo_array((np.ones(len(alike)), (first, second)), shape=(len(areas), len(areas)))
    count, group_of = connected_components(links, directed=False) if areas else (0, [])
    groups: list[list[Area]] = [[] for _ in range(count)]
    for area, group in zip(areas, group_of, strict=True):
        groups[group].append(area)
    return sorted(groups, key=lambda group: group[0].id)


def _join(group: Sequence[Area]) -> Area:
    if len(group) == 1:
        return group[0]
    weights = [max(len(area.trajectory), 1) for area in group]
    return replace(
        group[0],
        confidence=float(np.average([area.confidence for area in group], weights=weights)),
        margin=float(np.average([area.margin for area in group], weights=weights)),
        probabilities=_averaged([area.probabilities for area in group], weights),
        scores=_averaged([area.scores for area in group], weights),
        start=min(area.start for area in group),
        end=max(area.end for area in group),
        trajectory=tuple(point for area in group for point in area.trajectory),
    )


def _averaged(tables: Sequence[Mapping[str, float]], weights: Sequence[int]) -> dict[str, float]:
    return {
        name: float(np.average([table[name] for table in tables], weights=weights))
        for name in tables[0]
    }
