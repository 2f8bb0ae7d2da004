"""What a command makes of corrected poses once the log is read: they are known best at its end."""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from placecue.accumulator import Accumulator, AreaUpdate
from placecue.atomic import write_text
from placecue.belief import Belief
from placecue.commands import files
from placecue.evaluation.surroundings import Surroundings
from placecue.free_space import FreeSpace
from placecue.observation import Observation
from placecue.semantic_map import SemanticMap
from placecue.sharpness import SMEARED, Sharpness
from placecue.slam.planar import pose_of
from placecue.slam.retold import Retold
from placecue.slam.straightened import straightened_in
from placecue.slam.trajectory import tum
from placecue.source import Source


class _Told:
    """What was told over time, kept where it changed."""

    def __init__(self) -> None:
        self._stamps = array("q")
        self._told: list[str | None] = []

    def add(self, stamp: int, told: str | None) -> None:
        if not self._told or self._told[-1] != told:
            self._stamps.append(stamp)
            self._told.append(told)

    def at(self, stamp: int) -> str | None:
        number = bisect_right(self._stamps, stamp) - 1
        return self._told[number] if number >= 0 else None


class Straightening:
    """The map that the poses of a log are corrected by, with the labels of its places; a listener.

    Parameters
    ----------
    source : Source
        The log; without ``slam=true`` there is nothing to do.
    """

    def __init__(self, source: Source) -> None:
        self.sources = straightened_in(source)
        self._labels: dict[str, _Told] = defaultdict(_Told)  # by frame
        self._beliefs: dict[str, _Told] = defaultdict(_Told)

    def observe(
        self,
        observation: Observation,
        belief: Belief | None = None,
        update: AreaUpdate | None = None,
    ) -> None:
        """Note the label of one observation and what is believed."""
        if not self.sources or observation.pose is None:
            return
        stamp, frame = observation.stamp, observation.pose.frame
        self._labels[frame].add(stamp, observation.label)
        self._beliefs[frame].add(stamp, None if belief is None else belief.label)

    def observations(self) -> Iterator[Observation]:
        """Yield what each map is made of, at the poses of now and with the labels told."""
        for source in self.sources:
            labels = self._labels[source.frame]
            for each in source.mapper.observations():
                yield each.relabelled(labels.at(each.stamp))

    def following(self, accumulator: Accumulator) -> Accumulator:
        """Return an accumulator whose map follows late corrections, where there can be any."""
        return Retold(accumulator) if self.sources else accumulator

    def drawn(self, around: Surroundings, space: FreeSpace) -> tuple[Surroundings, FreeSpace]:
        """Return what the laser hit and free space by the poses of now, else what there is."""
        new_around, new_space = Surroundings(around.cell), FreeSpace(space.cell)
        for each in self.observations():
            new_around.observe(each, None, None)
            new_space.observe(each)
        self._believed(new_around)
        return (around, space) if new_space.frame is None else (new_around, new_space)

    def _believed(self, around: Surroundings) -> None:
        """Tell what was believed along the way, at the poses of now."""
        for source in self.sources:
            beliefs, way = self._beliefs[source.frame], source.mapper.trajectory
            if source.frame != around.frame:
                continue  # a picture shows one map
            poses = way.poses(source.mapper.poses)
            for stamp, pose in zip(way.stamps().tolist(), poses, strict=True):
                if (label := beliefs.at(stamp)) is not None:
                    around.believe(pose_of(pose, source.frame), label)

    def sure(self, semantic_map: SemanticMap) -> SemanticMap:
        """Return a map whose nodes know how sure they are, where poses were corrected."""
        mappers = {each.frame: each.mapper for each in self.sources if each.mapper.keyframes}
        frames = {area.id: area.frame for area in semantic_map.areas}
        nodes = []
        for node in semantic_map.nodes:
            mapper = mappers.get(frames[node.area])
            known = None if mapper is None else mapper.sure_of(node.x, node.y)
            nodes.append(replace(node, uncertainty=known))
        return replace(semantic_map, nodes=tuple(nodes))

    def write(self, out: Path) -> None:
        """Write the trajectory where poses were corrected; that of each log after the other."""
        if self.sources:
            maps = (source.mapper for source in self.sources)
            told = [
                tum(each.trajectory.stamps(), each.trajectory.poses(each.poses)) for each in maps
            ]
            write_text(out / files.TRAJECTORY, "".join(told))


def advice(sharpness: Sharpness) -> list[str]:
    """Return a line that advises to correct poses where walls come out smeared."""
    share = sharpness.seen.share
    if share is None or share >= SMEARED:
        return []
    return [
        f"walls come out smeared: of what was seen again, {100 * share:.0f} % lies where it was "
        f"(straight walls: {100 * SMEARED:.0f} % and more); slam=true corrects the poses by the "
        "scans"
    ]


def trajectory(out: Path) -> list[tuple[str, Path]]:
    """Return the corrected trajectory in a folder, with a word on it, where there is one."""
    path = out / files.TRAJECTORY
    return [("corrected trajectory, as evo reads it (TUM)", path)] if path.is_file() else []
