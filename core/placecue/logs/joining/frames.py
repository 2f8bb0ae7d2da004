"""Which frames a log has: its transforms looked through, the robot's and the fixed one found."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from mcap.records import Message

from placecue.errors import DataError, UnusableObservation, UsageError
from placecue.logs.joining.items import TopicReader
from placecue.logs.joining.transforms import Edge, TransformBuffer
from placecue.logs.mcap.container import LogFile, Topic
from placecue.logs.messages.geometry import Transform

log = logging.getLogger(__name__)

#: Names of the robot's own frame, the first that exists is taken.
BASE_FRAMES = ("base_link", "base_footprint", "base")
#: Names of the frame that the robot moves in, the first that exists is taken.
FIXED_FRAMES = ("map", "world", "odom", "odom_combined")
#: Words in the names of frames that move with a robot.
CARRIED = re.compile(r"base|camera|optical|laser|lidar|link|imu|sensor|gripper|hand", re.IGNORECASE)
#: Those of them that are no robot's own.
PARTS_OF_ROBOTS = re.compile(r"camera|optical|laser|lidar|imu|sensor|gripper|hand", re.IGNORECASE)
#: So long is looked on where frames were found connected late, s.
MORE = 3.0


def plain(frame: str) -> str:
    """Return the name of a frame without the leading slash of old systems."""
    return frame.lstrip("/")


def own_name(frame: str) -> str:
    """Return the name of a frame without its namespace: ``odom`` of ``robot1/odom``."""
    return frame.rpartition("/")[2]


def is_static(topic: Topic) -> bool:
    """Tell whether the transforms of a topic hold at all times."""
    return "static" in topic.name.lower()


def namespace(topic: Topic) -> str:
    """Return whose transforms a topic has: ``/robot1`` of ``/robot1/tf``."""
    before, _, name = topic.name.rpartition("/")
    return before if name.lower() in ("tf", "tf_static") else ""


def of_one_robot(
    topics: Sequence[Topic], near: str | None, wanted: str | None, where: str
) -> tuple[Topic, ...]:
    """Return those topics with transforms that belong to one robot.

    Parameters
    ----------
    topics : sequence of Topic
        All with transforms.
    near : str or None
        A topic of the robot: its namespace says which it is.
    wanted : str or None
        One of the topics, which the user asked for.
    where : str
        Name of the log, for messages.

    Raises
    ------
    UsageError
        If there are several robots and nothing says which.
    """
    spaces = sorted({namespace(topic) for topic in topics if not is_static(topic)})
    asked = next((namespace(topic) for topic in topics if topic.name == wanted), None)
    if asked is None and len(spaces) > 1:
        holding = [space for space in spaces if near and near.startswith(f"{space}/")]
        if not holding:
            names = [topic.name for topic in topics if not is_static(topic)]
            raise UsageError(
                f"{where} has the transforms of {len(spaces)} robots: {', '.join(names)}; choose "
                f"one, such as source.pose_topic={names[0]}"
            )
        asked = max(holding, key=len)
    if asked is None:
        asked = spaces[0] if spaces else _nearest({namespace(topic) for topic in topics}, near)
    own = [topic for topic in topics if namespace(topic) == asked]
    if any(is_static(topic) for topic in own):
        return tuple(own)
    shared = [t for t in topics if is_static(t) and f"{asked}/".startswith(f"{namespace(t)}/")]
    rest = [topic for topic in topics if is_static(topic) and namespace(topic) not in spaces]
    return (*own, *(shared or (rest if len({namespace(t) for t in rest}) == 1 else [])))


def _nearest(spaces: Iterable[str], near: str | None) -> str:
    holding = [space for space in spaces if near and near.startswith(f"{space}/")]
    return max(holding or spaces, key=len, default="")


class TransformReader(TopicReader):
    """Takes transforms into a buffer.

    Parameters
    ----------
    file : LogFile
        The log.
    topic : Topic
        One with transforms.
    """

    def __init__(self, file: LogFile, topic: Topic) -> None:
        super().__init__(file, topic)
        self.static = self.lasts = is_static(topic)

    def take_in(self, message: Message, buffer: TransformBuffer) -> None:
        """Take the transforms of a message into a buffer.

        Raises
        ------
        UnusableObservation
            If it cannot be decoded.
        """
        item = self.item(message)
        for each in [] if item is None else item.value():
            buffer.add(self._timed(each, message), self.static)

    def _timed(self, each: Transform, message: Message) -> Transform:
        stamp = self.timed(each.stamp, message.log_time)
        return Transform(
            plain(each.parent), plain(each.child), each.translation, each.rotation, stamp
        )


def readers_of(file: LogFile, topics: Iterable[Topic]) -> list[TransformReader]:
    """Return readers of transforms; those that cannot be decoded are told of and left out."""
    found = []
    for topic in topics:
        try:
            found.append(TransformReader(file, topic))
        except DataError as error:
            log.warning(f"{file.path}: {error}; its transforms are left out")
    return found


Enough = Callable[[TransformBuffer], bool]


@dataclass(frozen=True, slots=True)
class Survey:
    """What a look at the transforms of a log found.

    Parameters
    ----------
    buffer : TransformBuffer
        The transforms.
    until : int
        Log time of the last message looked at, ns.
    late : float
        How long after the first transform the wanted frames were connected, where that was after
        the beginning that is searched anyway, s; else 0.
    static : int or None
        How many messages of static transforms were looked at; None for all.
    """

    buffer: TransformBuffer
    until: int
    late: float = 0.0
    static: int | None = None

    def holding(self, edge: Edge, gap: int) -> bool:
        """Tell whether transforms come too seldom to interpolate between them."""
        stamps = [each.stamp for each in edge.history]
        steps = [after - before for before, after in pairwise(stamps)]
        return median(steps) > gap if steps else self.until - stamps[0] > 2 * gap


def look(
    file: LogFile, readers: Sequence[TransformReader], horizon: float, early: Enough, late: Enough
) -> Survey:
    """Look at the transforms of a log.

    At those of the first ``horizon`` seconds; at the static ones wherever they are; and where that
    is not enough, at all of them up to where it is.

    Parameters
    ----------
    file : LogFile
        The log.
    readers : sequence of TransformReader
        Of its transforms.
    horizon : float
        Length of the beginning, from the first transform on, s.
    early, late : callable
        Tell whether a buffer has enough to stop at any time, or when the beginning is over.
    """
    buffer = TransformBuffer()
    of = {number: reader for reader in readers for number in reader.topic.channels}
    static = [number for number, reader in of.items() if reader.static]
    first = last = seen = 0
    rest = False
    for message in file.messages(of) if of else ():
        last = message.log_time
        first = first or last
        if last - first >= horizon * 1e9:
            rest = True
            break
        _take_in(buffer, of[message.channel_id], message)
        seen += of[message.channel_id].static
        if early(buffer):
            return Survey(buffer, last, static=seen)
    if not rest or late(buffer):
        return Survey(buffer, last, static=seen if rest else None)
    for message in file.messages(static, first) if static else ():
        _take_in(buffer, of[message.channel_id], message)
    return Survey(buffer, last) if late(buffer) else _look_on(file, of, buffer, first, last, late)


def _look_on(
    file: LogFile,
    of: dict[int, TransformReader],
    buffer: TransformBuffer,
    first: int,
    since: int,
    late: Enough,
) -> Survey:
    found, last = 0, since
    for message in file.messages(of, since):
        last = message.log_time
        _take_in(buffer, of[message.channel_id], message)
        if not found and late(buffer):
            found = last
        if found and last - found >= MORE * 1e9:
            break
    return Survey(buffer, last, (found - first) * 1e-9 if found else 0.0)


def _take_in(buffer: TransformBuffer, reader: TransformReader, message: Message) -> None:
    try:
        reader.take_in(message, buffer)
    except UnusableObservation as error:
        buffer.faults.add("messages could not be used", str(error))


def named(frame: str, buffer: TransformBuffer) -> str:
    """Return a frame as the transforms call it: ``robot1/laser`` where there is no ``laser``."""
    frames = buffer.frames()
    if frame in frames or not frame:
        return frame
    alike = [each for each in frames if own_name(each) == own_name(frame)]
    return alike[0] if len(alike) == 1 else frame


def base_of(buffer: TransformBuffer, base_frame: str | None, near: str = "") -> str:
    """Return the robot's own frame.

    Parameters
    ----------
    buffer : TransformBuffer
        Transforms of the log.
    base_frame : str or None
        What the user calls it.
    near : str
        Another frame of the robot, which tells one robot from others.

    Raises
    ------
    UsageError
        If several robots have one, and nothing says which.
    """
    if base_frame is not None:
        return named(plain(base_frame), buffer)
    frames = buffer.frames()
    for name in BASE_FRAMES:
        if name in frames:
            return name
        alike = sorted(each for each in frames if own_name(each) == name)
        if len(alike) > 1:
            line = buffer.line(near)
            own = [f for f in alike if f in line or _space(f) == _space(near)]
            if len(own) != 1:
                raise UsageError(
                    f"the transforms have {len(alike)} robots: {', '.join(alike)}; choose one, "
                    f"such as source.base_frame={alike[0]}"
                )
            return own[0]
        if alike:
            return alike[0]
    return BASE_FRAMES[0]


def _space(frame: str) -> str:
    return frame.rpartition("/")[0]


def fixed_of(buffer: TransformBuffer, base: str, pose_frame: str | None) -> str | None:
    """Return the frame that the robot moves in, by transforms that move; None where none is."""
    if pose_frame is not None:
        fixed = named(plain(pose_frame), buffer)
        return fixed if buffer.connected(fixed, base) and fixed != base else None
    line = buffer.line(base)[1:]
    space = _space(base)
    beside = [f for f in sorted(buffer.frames()) if f != base and buffer.connected(f, base)]
    for name in FIXED_FRAMES:
        for frame in (*line, *sorted(beside, key=lambda each: _space(each) != space)):
            if own_name(frame) == name and buffer.moving(frame, base):
                return frame
    root = line[-1] if line else None
    if root is not None and buffer.moving(root, base) and not CARRIED.search(root):
        return root
    return None


def of_a_part(frame: str) -> bool:
    """Tell whether a frame is by its name that of a sensor or a hand, and not of the robot."""
    return PARTS_OF_ROBOTS.search(own_name(frame)) is not None


def may_be_fixed(frame: str, buffer: TransformBuffer, base: str) -> bool:
    """Tell whether a frame may be one that a robot moves in, and not one of the robot."""
    if own_name(frame) in FIXED_FRAMES:
        return True
    if frame in buffer.frames() and buffer.connected(frame, base):
        return base not in buffer.line(frame)
    return CARRIED.search(frame) is None
