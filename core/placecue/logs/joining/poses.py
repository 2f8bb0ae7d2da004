"""The robot's pose: out of transforms, or out of messages and carried by transforms."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, isfinite
from typing import Any

from mcap.records import Message

from placecue.errors import ComponentError, ContractError, UnusableObservation
from placecue.guard import Check, call
from placecue.logs.joining.frames import named, plain
from placecue.logs.joining.items import TopicReader
from placecue.logs.joining.transforms import TransformBuffer
from placecue.logs.mcap.container import LogFile, Topic
from placecue.logs.messages.geometry import FARTHEST, flatten
from placecue.observation import Pose2D


class Motion:
    """What transforms say of the robot's pose during one pass over a log.

    Parameters
    ----------
    buffer : TransformBuffer
        The transforms, filled as the log is read.
    base : str
        The robot's frame.
    fixed : str or None
        The frame to give poses in; None: as messages give them.
    from_transforms : bool
        Whether transforms alone give the pose.
    laser : str or None
        The laser's frame where it moves on the robot.
    """

    def __init__(
        self,
        buffer: TransformBuffer,
        base: str,
        fixed: str | None = None,
        from_transforms: bool = False,
        laser: str | None = None,
    ) -> None:
        self.buffer = buffer
        self.base = base
        self.fixed = fixed
        self.from_transforms = from_transforms
        self.laser = laser

    def reaches(self, stamp: int) -> bool:
        """Tell whether all transforms that are needed have got as far as a time, ns."""
        frames = [self.fixed, self.laser]
        wanted = [frame for frame in frames if frame is not None]
        return all(self.buffer.reaches(frame, self.base, stamp) for frame in wanted)

    def pose(self, stamp: int) -> Pose2D | None:
        """Return the pose at a time, None where transforms do not say it."""
        if self.fixed is None:
            return None
        matrix = self.buffer.lookup(self.fixed, self.base, stamp)
        return None if matrix is None else flatten(matrix, self.fixed)

    def carried(self, pose: Pose2D | None, stamp: int) -> Pose2D | None:
        """Return a pose that messages gave, in the frame that is asked for."""
        if pose is None or self.fixed is None or named(pose.frame, self.buffer) == self.fixed:
            return pose
        matrix = self.buffer.lookup(self.fixed, named(pose.frame, self.buffer), stamp)
        return None if matrix is None else flatten(matrix, self.fixed).compose(pose)


class PoseReader(TopicReader):
    """Takes poses out of messages, and carries them to the robot's frame.

    Parameters
    ----------
    file : LogFile
        The log.
    topic : Topic
        One with poses.
    motion : Motion or None
        Transforms, where the messages place another frame than the robot's; else None.
    """

    def __init__(self, file: LogFile, topic: Topic, motion: Motion | None) -> None:
        super().__init__(file, topic)
        self.motion = motion

    def _value(self, message: Message, stamp: int, decoded: Any) -> Any:
        pose = super()._value(message, stamp, decoded)
        far = hypot(pose.x, pose.y)
        if not (far <= FARTHEST and isfinite(pose.theta)):
            raise UnusableObservation(
                f"a pose of {self.topic.name} at {stamp} is not finite"
                if not isfinite(far + pose.theta)
                else f"a pose of {self.topic.name} at {stamp} is {far:g} m away"
            )
        motion = self.motion
        moved = None if motion is None else call(self.adapter, "moved", self.decoded(message))
        if motion is None or moved is None or not moved.child or moved.child == motion.base:
            return pose
        offset = motion.buffer.lookup(named(plain(moved.child), motion.buffer), motion.base, stamp)
        if offset is None:
            return pose
        return flatten(replace(moved, stamp=stamp).matrix() @ offset, pose.frame)


def first_of(file: LogFile, topic: Topic, method: str, check: Check | None = None) -> Any:
    """Return what an adapter's method gives of the first message that can be read, or None."""
    reader = TopicReader(file, topic)
    for message in file.messages(topic.channels):
        try:
            return call(reader.adapter, method, reader.decoded(message), check=check)
        except ContractError:
            raise
        except (UnusableObservation, ComponentError):
            continue  # counted when the log is read
    return None
