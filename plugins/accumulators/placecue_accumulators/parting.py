"""An area that turns out to be two: parted at a door, or where the beliefs have changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from placecue_accumulators.areas import AreaRecord
from placecue_accumulators.graph import NavigationGraph, Step
from placecue_accumulators.histogram import BinSums
from placecue_accumulators.judging import Judge, Judgement
from placecue_accumulators.way import Moment

if TYPE_CHECKING:
    from placecue_accumulators.journey import Journey

#: From the middle of a doorway to where its wall surely begins, m.
DOOR_HALF_WIDTH = 0.6


def part_at_gateway(journey: Journey, step: Step) -> None:
    """Part areas that a new door lies across, as the robot came in without seeing it."""
    graph, areas = journey.graph, journey.areas
    through = graph.part_at(step.node, DOOR_HALF_WIDTH)
    area_of = areas.area_of
    for area in sorted({area_of[a] for a, b in through if area_of[a] == area_of[b]}):
        record = areas.records[area]
        for piece in graph.pieces(record.nodes)[1:]:
            new = areas.begin(record.start, record.frame)
            new.end = record.end
            areas.move(piece, new)
            _share_way(graph, record, new)
            _rejudge(new, journey.judge)
            journey.news.add(new)
            if step.before in piece and journey.current is record:
                journey.current, journey.left = new, new.number
        _rejudge(record, journey.judge)


def part_at_change(journey: Journey) -> None:
    """Part the current area where beliefs changed; at a gateway that waits until it is left."""
    here, changed = journey.current, journey.changed
    if here is None or changed is None:
        return
    since, journey.changed = journey.recent.since(changed), None
    if not since:
        return
    reached = {moment.node for moment in since if moment.node != since[0].node}
    new = journey.areas.begin(since[0].stamp, here.frame)
    new.end = journey.odometer.stamp
    journey.areas.move([node for node in here.nodes if node in reached], new)
    for moment in since:
        if moment.key in here.way:
            new.way[moment.key] = here.way.pop(moment.key)
    here.end = since[0].stamp
    _part_evidence(journey, since[0], here)
    journey.news.add(here, finished=True)
    journey.left, journey.current, journey.entry = here.number, new, BinSums()
    journey.judge_area()
    journey.news.add(new)


def _part_evidence(journey: Journey, change: Moment, here: AreaRecord) -> None:
    """Leave what was seen before a change with the area that ended there."""
    before = journey.of_area.sums()
    journey.of_area.keep_since(change.of_area)
    before = before - journey.of_area.sums()
    if change.node is not None and change.node == journey.graph.current:
        at_node = journey.of_node.sums()
        journey.of_node.keep_since(change.of_node)
        if journey.areas.area_of[change.node] == here.number:
            journey.areas.store(change.node, at_node - journey.of_node.sums())
    if journey.judge is not None:
        seen = here.evidence if here.evidence.bins > 0 else before
        here.judged = Judgement()
        here.judge(seen, journey.judge)


def _share_way(graph: NavigationGraph, record: AreaRecord, new: AreaRecord) -> None:
    """Hand a new area the positions that are nearer to its nodes than to the old one's."""
    at = [
        np.array([(graph.places[n].x, graph.places[n].y) for n in each.nodes])
        for each in (record, new)
    ]
    for key, position in list(record.way.items()):
        kept, taken = (np.hypot(*(nodes - position).T).min() for nodes in at)
        if taken < kept:
            new.way[key] = record.way.pop(key)


def _rejudge(record: AreaRecord, judge: Judge | None) -> None:
    if judge is not None and record.evidence.bins > 0:
        record.judged = Judgement()
        record.judge(record.evidence, judge)
