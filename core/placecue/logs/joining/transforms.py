"""Transforms between frames over time: what ``lookup`` of tf2 gives, from the past of a log."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from placecue.faults import Faults
from placecue.logs.messages.geometry import Matrix, Transform, normalised, rigid, slerp

#: Of an edge that moves this many transforms are kept, however old they are.
FEW = 16
#: So many frames are known by name; a log that names more is damaged.
MANY = 10_000


def _stamp(transform: Transform) -> int:
    return transform.stamp


class Edge:
    """Where one frame lay in its parent, over time.

    Parameters
    ----------
    static : bool
        Whether a transform holds until the next one, and the first also before it.
    """

    __slots__ = ("history", "static")

    def __init__(self, static: bool) -> None:
        self.static = static
        self.history: list[Transform] = []  # in order of time, never empty but at first

    def add(self, transform: Transform) -> None:
        """Take in a transform; it replaces one of the same time."""
        history = self.history
        if not history or history[-1].stamp < transform.stamp:
            history.append(transform)
            return
        at = bisect_left(history, transform.stamp, key=_stamp)
        if history[at].stamp == transform.stamp:
            history[at] = transform
        else:
            history.insert(at, transform)

    def says(self, transform: Transform) -> bool:
        """Tell whether a transform is what holds at its time anyway."""
        before, after = self.around(transform.stamp)
        found = before or after
        return found is not None and replace(found, stamp=transform.stamp) == transform

    def at(self, stamp: int, tolerance: int, gap: int) -> Matrix | None:
        """Return the matrix at a time, None where none is near enough; see TransformBuffer."""
        found = self.around(stamp)
        before, after = found
        if self.static or before is None or after is None or before.stamp == stamp:
            return _within(before or after, stamp, None if self.static else tolerance)
        if after.stamp - before.stamp > gap:
            nearest = min(before, after, key=lambda each: abs(each.stamp - stamp))
            return _within(nearest, stamp, tolerance)
        if before.parent != after.parent:
            return before.matrix()
        share = (stamp - before.stamp) / (after.stamp - before.stamp)
        pairs = zip(before.translation, after.translation, strict=True)
        x, y, z = (a + share * (b - a) for a, b in pairs)
        return rigid((x, y, z), slerp(before.rotation, after.rotation, share))

    def around(self, stamp: int) -> tuple[Transform | None, Transform | None]:
        """Return the last transform at or before a time and the first one after it."""
        after = bisect_right(self.history, stamp, key=_stamp)
        return (
            self.history[after - 1] if after else None,
            self.history[after] if after < len(self.history) else None,
        )

    def parent(self, stamp: int | None) -> str:
        """Return the parent at a time, or the newest one."""
        if stamp is None:
            return self.history[-1].parent
        before, after = self.around(stamp)
        found = before or after
        assert found is not None  # the history is not empty
        return found.parent

    def forget_before(self, stamp: int) -> None:
        """Drop what lies before a time, but for the last one of it, once it is worth it."""
        keep = bisect_right(self.history, stamp, key=_stamp) - 1
        if keep >= FEW and not self.static:
            del self.history[:keep]

    def forget_after(self, stamp: int) -> None:
        """Drop what lies after a time, but never all."""
        del self.history[max(bisect_right(self.history, stamp, key=_stamp), 1) :]


def _within(transform: Transform | None, stamp: int, tolerance: int | None) -> Matrix | None:
    if transform is None or (tolerance is not None and abs(transform.stamp - stamp) > tolerance):
        return None
    return transform.matrix()


class TransformBuffer:
    """Frames of reference and where each lay in its parent, over time.

    A transform that is not static holds at its own time; between two of them it is interpolated,
    along the line and by slerp. Before the first and after the last one, and in gaps, the nearest
    one is taken if it is near enough. What a static one says holds from its time until the next,
    and the first also before. Where a frame changed its parent, it hangs from each in its time.
    (Foote, tf: The transform library, 2013.)

    Parameters
    ----------
    tolerance : int
        How far a time may be from the nearest transform, ns.
    gap : int
        How far apart two transforms may be to interpolate between them, ns.

    Attributes
    ----------
    faults : Faults
        Transforms that were left out.
    changes : int
        How often a static transform came that says something new.
    """

    def __init__(self, tolerance: int = 100_000_000, gap: int = 1_000_000_000) -> None:
        self.tolerance = tolerance
        self.gap = gap
        self.edges: dict[str, Edge] = {}
        self.faults = Faults()
        self.changes = 0
        self._frames: set[str] = set()

    def add(self, transform: Transform, static: bool = False) -> None:
        """Take in a transform; one that says nothing is left out and counted.

        Whether a frame is static is decided by the first transform of it.
        """
        rotation = normalised(transform.rotation)
        fault = transform.fault()
        if fault is not None or rotation is None:
            example = f"{transform.parent} to {transform.child} at {transform.stamp}: {fault}"
            self.faults.add("transforms were left out", example)
            return
        edge = self.edges.get(transform.child)
        if edge is None and len(self.edges) >= MANY:
            return
        if edge is None:
            edge = self.edges[transform.child] = Edge(static)
        sound = replace(transform, rotation=rotation)
        if edge.static and edge.says(sound):
            return  # nodes that say it again and again would fill the memory
        edge.add(sound)
        self.changes += edge.static
        if len(self._frames) < MANY:
            self._frames |= {transform.child, transform.parent}

    def take(self, child: str, edge: Edge) -> None:
        """Take in a frame with its transforms, of another buffer."""
        self.edges[child] = edge
        self._frames |= {child, *(each.parent for each in edge.history)}

    def frames(self) -> set[str]:
        """Return the names of all frames."""
        return self._frames

    def line(self, frame: str, stamp: int | None = None) -> list[str]:
        """Return a frame and those above it, up to the root or until it goes in a circle."""
        line = [frame]
        while line[-1] in self.edges:
            parent = self.edges[line[-1]].parent(stamp)
            if parent in line:
                break
            line.append(parent)
        return line

    def steps(self, target: str, source: str, stamp: int | None = None) -> set[str] | None:
        """Return the frames whose transforms lead from one frame to another; None: unconnected."""
        above, line = self.line(target, stamp), self.line(source, stamp)
        common = next((frame for frame in line if frame in above), None)
        if common is None:
            return None
        return {*line[: line.index(common)], *above[: above.index(common)]}

    def connected(self, target: str, source: str) -> bool:
        """Tell whether two frames are connected now."""
        return self.steps(target, source) is not None

    def lookup(
        self, target: str, source: str, stamp: int, tolerance: int | None = None
    ) -> Matrix | None:
        """Return the matrix that takes ``source`` coordinates to ``target`` at a time, (4, 4).

        None where they are not connected, or a transform between them is not near enough in time.

        Parameters
        ----------
        target, source : str
            Names of frames.
        stamp : int
            Time, ns.
        tolerance : int, optional
            In place of the buffer's, ns.
        """
        above, line = self.line(target, stamp), self.line(source, stamp)
        common = next((frame for frame in line if frame in above), None)
        if common is None:
            return None
        within = self.tolerance if tolerance is None else tolerance
        up = self._product(line[: line.index(common)], stamp, within)
        down = self._product(above[: above.index(common)], stamp, within)
        if up is None or down is None:
            return None
        return np.asarray(_inverse(down) @ up)

    def _product(self, line: Iterable[str], stamp: int, tolerance: int) -> Matrix | None:
        product: Matrix = np.eye(4)
        for frame in line:
            matrix = self.edges[frame].at(stamp, tolerance, self.gap)
            if matrix is None:
                return None
            product = matrix @ product
        return product

    def moving(self, target: str, source: str) -> bool:
        """Tell whether a transform that is not static lies between two frames."""
        return any(not self.edges[frame].static for frame in self.steps(target, source) or ())

    def holds(self, target: str, source: str) -> bool:
        """Tell whether all between two frames is static, and has said one thing so far."""
        edges = [self.edges[frame] for frame in self.steps(target, source) or ()]
        return all(edge.static and len(edge.history) == 1 for edge in edges)

    def reaches(self, target: str, source: str, stamp: int) -> bool:
        """Tell whether all that moves between two frames has got as far as a time."""
        edges = [self.edges[frame] for frame in self.steps(target, source) or ()]
        return all(edge.static or edge.history[-1].stamp >= stamp for edge in edges)

    def forget_before(self, stamp: int) -> None:
        """Drop what is not needed for times from ``stamp`` on, ns."""
        for edge in self.edges.values():
            edge.forget_before(stamp)

    def forget_after(self, stamp: int) -> None:
        """Drop what lies after a time, where the clock went back to it, ns."""
        for edge in self.edges.values():
            if not edge.static:
                edge.forget_after(stamp)


def _inverse(matrix: Matrix) -> Matrix:
    """Return the inverse of a rigid motion."""
    result: Matrix = np.eye(4)
    result[:3, :3] = matrix[:3, :3].T
    result[:3, 3] = -matrix[:3, :3].T @ matrix[:3, 3]
    return result
