"""Where the laser sits on the robot, and how the robot's pose follows from transforms."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import cos, isnan, radians

import numpy as np
from mcap.records import Message

from placecue.errors import DataError, UnusableObservation
from placecue.logs.joining.items import Item, TopicReader
from placecue.logs.mcap.container import LogFile, Topic
from placecue.logs.messages.geometry import Matrix, Transform, TransformTree, flatten
from placecue.observation import LaserScan, Pose2D

log = logging.getLogger(__name__)

#: Names of the robot's own frame, the first that exists is taken.
BASE_FRAMES = ("base_link", "base_footprint", "base")
#: Names of the frame that the robot moves in, the first that exists is taken.
FIXED_FRAMES = ("odom", "odom_combined", "map", "world")
#: A laser tilted by more than this does not look along the floor, rad.
LEVEL = radians(10.0)


@dataclass(frozen=True, slots=True)
class Mounting:
    """Where a scanner sits.

    Parameters
    ----------
    pose : Pose2D
        In the robot's frame.
    flipped : bool
        Whether the scanner hangs upside down, so that its angles run clockwise.
    range_max : float
        Limit of scans whose messages do not say theirs, m.
    """

    pose: Pose2D
    flipped: bool = False
    range_max: float = np.inf

    def place(self, scan: LaserScan) -> LaserScan:
        """Return a scan, given in its own frame, as it sits on the robot."""
        inner = scan.mount
        scan = replace(scan, range_max=self.range_max) if isnan(scan.range_max) else scan
        if not self.flipped:
            return replace(scan, mount=self.pose.compose(inner))
        mirrored = Pose2D(inner.x, -inner.y, -inner.theta)
        return replace(
            scan,
            angles=-scan.angles[::-1],
            ranges=scan.ranges[::-1].copy(),
            mount=self.pose.compose(mirrored),
        )


def read_tree(
    file: LogFile, topics: Iterable[Topic], wanted: tuple[str, str] | None, horizon: float
) -> TransformTree:
    """Read transforms from the beginning of a log.

    Static ones are read wherever they are, the others for ``horizon`` seconds.

    Parameters
    ----------
    file : LogFile
        The log.
    topics : iterable of Topic
        Those with transforms.
    wanted : tuple of 2 str, or None
        Stop as soon as these two frames are connected.
    horizon : float
        Length of the beginning, s.
    """
    tree = TransformTree()
    readers = _readers(file, topics)
    static = [i for i, reader in readers.items() if "static" in reader.topic.name]
    until = file.contents.start + int(horizon * 1e9)
    for channels, end in ((readers, until), (static, None)):
        for message in file.messages(channels, until=end) if channels else ():
            _take_in(tree, readers[message.channel_id], message)
            if wanted is not None and tree.lookup(*wanted) is not None:
                return tree
    return tree


def _readers(file: LogFile, topics: Iterable[Topic]) -> dict[int, TopicReader]:
    found: dict[int, TopicReader] = {}
    for topic in topics:
        try:
            reader = TopicReader(file, topic)
        except DataError as error:
            log.warning(f"{file.path}: {error}; its transforms are left out")
        else:
            found |= dict.fromkeys(topic.channels, reader)
    return found


def _take_in(tree: TransformTree, reader: TopicReader, message: Message) -> None:
    try:
        item = reader.item(message)
        for transform in [] if item is None else item.value():
            tree.add(transform)
    except UnusableObservation as error:
        log.debug("%s", error)


def base_frame_of(tree: TransformTree, base_frame: str | None) -> str:
    """Return the robot's own frame."""
    frames = tree.frames()
    return base_frame or next((each for each in BASE_FRAMES if each in frames), BASE_FRAMES[0])


def find_mounting(
    tree: TransformTree, laser: str, base_frame: str | None, range_max: float, where: str
) -> Mounting:
    """Work out where a laser sits from the transforms of a log.

    Parameters
    ----------
    tree : TransformTree
        Transforms of the log.
    laser : str
        The laser's frame.
    base_frame : str or None
        The robot's frame; None takes the usual names.
    range_max : float
        Limit of scans whose messages do not say theirs, m.
    where : str
        Name of the log, for messages.
    """
    base = base_frame_of(tree, base_frame)
    centre = Mounting(Pose2D(0.0, 0.0, 0.0, base), range_max=range_max)
    if laser == base or (not tree.transforms and base_frame is None):
        return centre
    matrix = tree.lookup(base, laser)
    if matrix is None:
        log.warning(
            f"{where}: no transform from '{base}' to the laser's frame '{laser}', so the laser is "
            f"taken to sit in the robot's centre; frames: {', '.join(sorted(tree.frames()))}; "
            "set source.base_frame or source.laser_frame"
        )
        return centre
    if abs(matrix[2, 2]) < cos(LEVEL):
        log.warning(
            f"{where}: the laser '{laser}' is tilted by "
            f"{np.degrees(np.arccos(abs(matrix[2, 2]))):.0f} degrees against '{base}'; its "
            "scans are read as if it were level"
        )
    return Mounting(flatten(matrix, base), bool(matrix[2, 2] < 0.0), range_max)


class TransformPoseReader(TopicReader):
    """Takes the robot's pose out of transforms, for logs without a topic of poses.

    Parameters
    ----------
    file : LogFile
        The log.
    topic : Topic
        One with transforms.
    parent, child : str
        The moving transform.
    offset : ndarray, shape (4, 4)
        From the robot's frame to ``child``.
    """

    def __init__(
        self, file: LogFile, topic: Topic, parent: str, child: str, offset: Matrix
    ) -> None:
        super().__init__(file, topic)
        self.role = "pose"
        self.parent = parent
        self.child = child
        self.offset = offset

    def item(self, message: Message) -> Item | None:
        """Return the pose in a message, None where it moves other frames only."""
        found = super().item(message)
        moves = (self.parent, self.child)
        for each in [] if found is None else found.value():
            if (each.parent, each.child) == moves:
                return Item(
                    each.stamp if each.stamp > 0 else message.log_time, "pose", self._pose(each)
                )
        return None

    def _pose(self, transform: Transform) -> Callable[[], Pose2D]:
        return lambda: flatten(transform.matrix() @ self.offset, self.parent)


def pose_readers(
    file: LogFile,
    topics: Iterable[Topic],
    tree: TransformTree,
    base_frame: str | None,
    pose_frame: str | None,
) -> list[TopicReader]:
    """Return readers of the robot's pose from transforms; none where they do not give one.

    Raises
    ------
    DataError
        If ``pose_frame`` is given and is not above the robot's frame.
    """
    base = base_frame_of(tree, base_frame)
    line = tree.ancestors(base)
    names = FIXED_FRAMES if pose_frame is None else (pose_frame,)
    parent = next((name for name in names if name in line[1:]), None)
    if parent is None:
        if pose_frame is not None:
            raise DataError(
                f"source.pose_frame={pose_frame} is not above '{base}' in the transforms of "
                f"{file.path}; above it: {', '.join(line[1:]) or 'none'}"
            )
        log.warning(
            f"{file.path}: no pose, for the transforms do not place '{base}' in any of "
            f"{', '.join(FIXED_FRAMES)}; frames: {', '.join(sorted(tree.frames())) or 'none'}; set "
            "source.base_frame or source.pose_frame"
        )
        return []
    child = line[line.index(parent) - 1]
    offset = tree.lookup(child, base)
    assert offset is not None  # both lie on one line
    return [TransformPoseReader(file, topic, parent, child, offset) for topic in topics]
