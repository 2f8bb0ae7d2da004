"""The frames of reference of one log: whose transforms, the robot's frame, the fixed one."""

from __future__ import annotations

import logging
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from placecue.errors import DataError, PlacecueError
from placecue.faults import Faults
from placecue.logs.adapters import contract
from placecue.logs.joining import clocks, depth, frames, mounting
from placecue.logs.joining.frames import FIXED_FRAMES, Survey, TransformReader
from placecue.logs.joining.mounting import Mountings
from placecue.logs.joining.poses import Motion, first_of
from placecue.logs.joining.topics import Choice, role_of, transforms
from placecue.logs.joining.transforms import Edge, TransformBuffer
from placecue.logs.mcap.container import Topic
from placecue.logs.messages.geometry import Transform

if TYPE_CHECKING:
    from placecue.logs.reader import McapLog

log = logging.getLogger(__name__)


class LogFrames:
    """The frames of reference of a log, looked up when they are asked for.

    Parameters
    ----------
    source : McapLog
        The log, with what its user asked for.
    """

    def __init__(self, source: McapLog) -> None:
        self.source = source
        self._surveys: dict[bool, Survey] = {}
        self._told: set[str] = set()

    # Topics.

    @cached_property
    def driver(self) -> Topic | None:
        """The images or scans, as far as one topic is chosen."""
        for part in ("image", "scan"):
            topic = self._chosen(part)
            if topic is not None:
                return topic
        return None

    @cached_property
    def scans(self) -> Topic | None:
        """The topic of the scans, as far as one is chosen."""
        return self._chosen("scan")

    def _chosen(self, part: str) -> Topic | None:
        source = self.source
        if source.parts is not None and part not in source.parts:
            return None
        try:
            return source.choose("image" if part == "image" else "scan").topic
        except PlacecueError:
            return None  # said where the parts are chosen

    @cached_property
    def topics(self) -> tuple[Topic, ...]:
        """The topics with the transforms of the robot."""
        near = self.scans or self.driver
        source = self.source
        found = transforms(source.topics)
        name = None if near is None else near.name
        return frames.of_one_robot(found, name, source.pose_topic, str(source.path))

    @cached_property
    def readers(self) -> list[TransformReader]:
        """Readers of the transforms, for looking at them."""
        return frames.readers_of(self.source.file, self.topics)

    def moving_topics(self) -> tuple[Topic, ...]:
        """Return the topics that place the robot in a fixed frame; none if they do not."""
        moving = tuple(topic for topic in self.topics if not frames.is_static(topic))
        if not moving or self.source.pose_frame is not None:
            return moving  # what is wrong with the frame is said when it is looked up
        return moving if self.fixed is not None else ()

    @cached_property
    def unplaced(self) -> str | None:
        """Why the transforms that there are give no pose, and what to type; None if they do."""
        if self.moving_topics() or all(map(frames.is_static, self.topics)):
            return None
        buffer = self.survey(True).buffer
        return _unplaced(buffer, self._base(buffer))

    # Frames.

    @cached_property
    def laser(self) -> str:
        """The laser's frame, as the first scan names it; empty where there are no scans."""
        if self.source.laser_frame is not None:
            return frames.plain(self.source.laser_frame)
        if self.scans is None:
            return ""
        return first_of(self.source.file, self.scans, "frame", contract.text) or ""

    @cached_property
    def placed(self) -> Transform | None:
        """Where the first message of the pose topic puts which frame, if it says so."""
        topic = self.pose_topic
        return None if topic is None else first_of(self.source.file, topic, "moved")

    @property
    def pose_topic(self) -> Topic | None:
        """The topic of poses that are no transforms."""
        choice = self.source.choices.get("pose")
        topic = None if choice is None else choice.topic
        return topic if topic is not None and role_of(topic) == "pose" else None

    def survey(self, pose: bool) -> Survey:
        """Return what a look at the transforms found.

        Parameters
        ----------
        pose : bool
            Whether they are to place the robot, too.
        """
        if True in self._surveys:
            return self._surveys[True]
        if pose not in self._surveys:
            self._surveys[pose] = self._look(pose)
        return self._surveys[pose]

    def _look(self, pose: bool) -> Survey:
        source, laser = self.source, self.laser
        base = frames.plain(source.base_frame or frames.BASE_FRAMES[0])

        def mounted(buffer: TransformBuffer, base: str) -> bool:
            return not laser or buffer.connected(base, frames.named(laser, buffer))

        def early(buffer: TransformBuffer) -> bool:
            return not pose and base in buffer.frames() and mounted(buffer, base)

        def late(buffer: TransformBuffer) -> bool:
            found = self._base(buffer)
            fixed = not pose or frames.fixed_of(buffer, found, source.pose_frame) is not None
            return fixed and mounted(buffer, found)

        found = frames.look(source.file, self.readers, source.transform_horizon, early, late)
        if self.scans is not None and self.scans.depth and found.buffer.edges:
            found.buffer.add(depth.looking_ahead(laser), static=True)
        if found.late:
            self._tell(f"transforms place the robot from {found.late:.1f} s after their first on")
        return found

    def _base(self, buffer: TransformBuffer) -> str:
        return frames.base_of(buffer, self.source.base_frame, self.laser)

    @property
    def fixed(self) -> str | None:
        """The frame that transforms place the robot in."""
        buffer = self.survey(True).buffer
        return frames.fixed_of(buffer, self._base(buffer), self.source.pose_frame)

    def may_be_fixed(self, topic: Topic) -> bool:
        """Tell whether the poses of a topic are in a frame that may be fixed."""
        frame = first_of(self.source.file, topic, "frame") or ""
        buffer = self.survey(False).buffer if self.topics else TransformBuffer()
        return frames.may_be_fixed(frame, buffer, self._base(buffer))

    def told(self, choice: Choice) -> str:
        """Return the frames of a choice in a few words."""
        if choice.part != "pose" or choice.topic is None:
            return ""
        if role_of(choice.topic) == "transform":
            fixed = self.fixed
            return "" if fixed is None else f"{fixed} to {self._base(self.survey(True).buffer)}"
        asked = self.source.pose_frame
        own = first_of(self.source.file, choice.topic, "frame") or "no frame"
        return f"in {asked}, carried from {own}" if asked and asked != own else f"in {own}"

    # One pass.

    def motion(self, faults: Faults) -> Motion:
        """Return what transforms say of robot and laser, for one pass over the log.

        Raises
        ------
        DataError
            If ``pose_frame`` is given and transforms do not connect it to the robot.
        """
        source = self.source
        choice = source.choices.get("pose")
        alone = choice is not None and choice.topic is not None and self.pose_topic is None
        posed = alone or (source.pose_frame is not None and self.pose_topic is not None)
        if not posed and self.scans is None and self.pose_topic is None:
            return Motion(TransformBuffer(), frames.BASE_FRAMES[0])
        survey = self.survey(posed)
        base, laser = self._base(survey.buffer), frames.named(self.laser, survey.buffer)
        placed = self.placed
        child = frames.named(placed.child, survey.buffer) if placed is not None else base
        if source.base_frame is None and base not in survey.buffer.frames():
            base = child if child in survey.buffer.frames() else base
        fixed = self._fixed(survey, base, alone) if posed else None
        ends = [frame for frame in (fixed, laser, child) if frame and frame != base]
        if self.pose_topic is not None and child != base:
            self._tell_of_child(survey.buffer, child, base)
        moving = [frame for frame in ends if survey.buffer.moving(base, frame)]
        if fixed is not None and not alone and placed is not None:
            moving.append(fixed)
        if not moving and not self._restated(survey):
            faults.join(survey.buffer.faults)
            return Motion(survey.buffer, base, fixed, alone)
        buffer = self._seeded(survey, fixed, base)
        turned = [frame for frame in (laser, child) if frame in moving]
        return Motion(buffer, base, fixed, alone, turned, moves=bool(moving))

    def carries(self, motion: Motion) -> bool:
        """Tell whether poses are of another frame than the robot's, and have to be carried."""
        placed = self.placed
        if placed is None or not placed.child:
            return False
        child = frames.named(placed.child, motion.buffer)
        return child != motion.base and motion.buffer.connected(child, motion.base)

    def taken_in(self, motion: Motion) -> tuple[Topic, ...]:
        """Return the topics whose transforms a pass has to take in."""
        known = any(motion.buffer is each.buffer for each in self._surveys.values())
        if known or not motion.buffer.edges:
            return ()
        if motion.moves:
            return self.topics
        return tuple(topic for topic in self.topics if frames.is_static(topic))

    def _restated(self, survey: Survey) -> bool:
        """Tell whether static transforms come that the look before has not seen."""
        counts = [topic.count for topic in self.topics if frames.is_static(topic)]
        seen = survey.static
        if seen is None or not counts:
            return False
        return None in counts or sum(count or 0 for count in counts) > seen

    def mountings(self, motion: Motion, faults: Faults) -> Mountings:
        """Return where lasers sit on the robot, for one pass over the log."""
        source, laser, scans = self.source, self.laser, self.scans
        forced = laser if source.laser_frame is not None else None
        if scans is not None and scans.depth:
            forced = depth.looking_ahead(laser).child if motion.buffer.edges else laser
        shown = forced or laser
        if shown not in self._told:
            self._told.add(shown)
            asked = source.base_frame is not None
            mounting.check_mounting(motion.buffer, motion.base, shown, asked, str(source.path))
        return Mountings(motion.buffer, motion.base, forced, source.range_max, faults)

    def _fixed(self, survey: Survey, base: str, alone: bool) -> str | None:
        source, buffer = self.source, survey.buffer
        fixed = frames.fixed_of(buffer, base, source.pose_frame)
        if fixed is None and not alone and self.placed is not None:
            own = frames.named(self.placed.parent, buffer)
            asked = frames.named(frames.plain(source.pose_frame or own), buffer)
            fixed = asked if buffer.connected(asked, own) else None
        if fixed is None and source.pose_frame is not None:
            raise DataError(
                f"source.pose_frame={source.pose_frame} is not above '{base}' in the transforms "
                f"of {source.path}; above it: {', '.join(buffer.line(base)[1:]) or 'none'}"
            )
        if fixed is None:
            self._tell(f"no pose: {_unplaced(buffer, base)}")
        return fixed

    def _tell_of_child(self, buffer: TransformBuffer, child: str, base: str) -> None:
        lone = not buffer.edges and child != self.laser and frames.of_a_part(child)
        if lone or (buffer.edges and not buffer.connected(child, base)):
            self._tell(
                f"poses are of '{child}', which transforms do not connect to '{base}': they are "
                "taken to be the robot's"
            )

    def _seeded(self, survey: Survey, fixed: str | None, base: str) -> TransformBuffer:
        """Return a buffer for one pass: with what is static, and how all began."""
        source = self.source
        tolerance, gap = round(source.tolerance * 1e9), round(source.pose_gap * 1e9)
        buffer = TransformBuffer(tolerance, gap)
        held = self._held(survey, fixed, base, gap)
        for child, edge in survey.buffer.edges.items():
            made = Edge(edge.static or child in held)
            made.history = list(edge.history) if edge.static else [self._shifted(edge.history[0])]
            buffer.take(child, made)
        return buffer

    def _shifted(self, first: Transform) -> Transform:
        """Return a transform of the look before, on the clock of the drivers."""
        behind, driver = self.source.behind, self.driver
        moving = next(t.name for t in self.topics if not frames.is_static(t))
        name = moving if driver is None else driver.name
        shift = clocks.shift_of(behind, moving, name, transforms=True)
        return replace(first, stamp=first.stamp + shift)

    def _held(self, survey: Survey, fixed: str | None, base: str, gap: int) -> set[str]:
        """Return the frames whose transforms come so seldom that each holds until the next."""
        buffer = survey.buffer
        steps = set() if fixed is None else buffer.steps(fixed, base) or set()
        moving = {child for child in steps if not buffer.edges[child].static}
        slow = {child for child in moving if survey.holding(buffer.edges[child], gap)}
        if not slow or slow == moving:
            return set()
        named = ", ".join(f"'{buffer.edges[c].parent(None)}' to '{c}'" for c in sorted(slow))
        self._tell(f"transforms come seldom of {named}: each holds until the next")
        return slow

    def _tell(self, text: str) -> None:
        if text not in self._told:
            self._told.add(text)
            log.warning(f"{self.source.path}: {text}")


def _unplaced(buffer: TransformBuffer, base: str) -> str:
    known = ", ".join(sorted(buffer.frames())) or "none"
    return (
        f"the transforms do not place '{base}' in any of {', '.join(FIXED_FRAMES)}; frames: "
        f"{known}; set source.base_frame or source.pose_frame"
    )
