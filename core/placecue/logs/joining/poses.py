"""The robot's pose: out of transforms, or out of messages and carried by transforms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, isfinite
from typing import Any

from mcap.records import Message

from placecue.errors import ComponentError, ContractError, UnusableObservation
from placecue.faults import Faults
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
    turned : sequence of str
        Frames that move on the robot and are needed: of the laser, or that poses are of.
    moves : bool
        Whether any of the transforms that are needed moves.
    """

    def __init__(
        self,
        buffer: TransformBuffer,
        base: str,
        fixed: str | None = None,
        from_transforms: bool = False,
        turned: Sequence[str] = (),
        moves: bool = False,
    ) -> None:
        self.moves = moves
        self.buffer = buffer
        self.base = base
        self.fixed = fixed
        self.from_transforms = from_transforms
        self.turned = tuple(turned)

    def reaches(self, stamp: int) -> bool:
        """Tell whether all transforms that are needed have got as far as a time, ns."""
        wanted = self.turned if self.fixed is None else (self.fixed, *self.turned)
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
    faults : Faults
        Takes what had to be assumed.
    """

    def __init__(self, file: LogFile, topic: Topic, motion: Motion | None, faults: Faults) -> None:
        super().__init__(file, topic)
        self.motion = motion
        self.faults = faults

    def _value(self, message: Message, stamp: int, decoded: Any) -> Any:
        decoded = self.decoded(message) if decoded is None else decoded
        pose = super()._value(message, stamp, decoded)
        far = hypot(pose.x, pose.y)
        if not (far <= FARTHEST and isfinite(pose.theta)):
            raise UnusableObservation(
                f"a pose of {self.topic.name} at {stamp} is not finite"
                if not isfinite(far + pose.theta)
                else f"a pose of {self.topic.name} at {stamp} is {far:g} m away"
            )
        if pose.theta == 0.0 and not self.adapter.is_turned(decoded):
            example = f"of {self.topic.name} at {stamp}"
            self.faults.add("poses say no heading, and are taken to look along x", example)
        motion = self.motion
        moved = None if motion is None else call(self.adapter, "moved", decoded)
        if motion is None or moved is None or not moved.child or moved.child == motion.base:
            return pose
        offset = motion.buffer.lookup(named(plain(moved.child), motion.buffer), motion.base, stamp)
        if offset is None:
            raise UnusableObservation(
                f"a pose of '{moved.child}' at {stamp} cannot be carried to '{motion.base}': no "
                "transform is near in time"
            )
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
