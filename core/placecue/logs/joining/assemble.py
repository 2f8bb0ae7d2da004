"""From matched messages to an observation."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from placecue.errors import UnusableObservation
from placecue.faults import Faults
from placecue.logs.joining.items import Item
from placecue.logs.joining.labels import Intervals
from placecue.logs.joining.poses import Motion
from placecue.logs.joining.synchronise import Match, interpolate
from placecue.observation import Observation, Part, Pose2D


class Assembler:
    """Decodes what matches hold; what does not decode is counted and left out.

    Parameters
    ----------
    driver : {"image", "scan"}
        The part that makes an observation.
    parts : collection of {"image", "scan", "pose"}
        The parts that have a topic.
    intervals : Intervals or None
        Labels beside the log; they take the place of those in it.
    faults : Faults
        Takes what goes wrong.
    motion : Motion, optional
        Transforms that give poses, or carry them to the frame that is asked for.
    recorded : bool
        Whether the intervals are on the recorder's clock and not on that of the stamps.
    """

    def __init__(
        self,
        driver: Part,
        parts: Collection[Part],
        intervals: Intervals | None,
        faults: Faults,
        motion: Motion | None = None,
        recorded: bool = False,
    ) -> None:
        self.motion = motion
        self.recorded = recorded
        self.driver = driver
        self.parts = parts
        self.intervals = intervals
        self.faults = faults
        self._frame: str | None = None  # of the last pose

    def observation(self, match: Match) -> Observation | None:
        """Return the observation of a match; None where its driver does not decode."""
        driver = self._value(match.driver)
        if driver is None:
            return None
        images = match.driver.role == "image"
        scan, pose = self._scan(match) if images else driver, self._pose(match)
        if scan is not None and pose is not None and scan.mount.frame == pose.frame:
            scan = replace(scan, mount=pose.inverse().compose(scan.mount))
        return Observation(
            match.driver.stamp,
            image=driver if images else None,
            scan=scan,
            pose=pose,
            label=self.label(match),
        )

    def place(self, match: Match) -> Observation:
        """Return where a match is and under what label, without its driver and its scan."""
        return Observation(match.driver.stamp, pose=self._pose(match), label=self.label(match))

    def label(self, match: Match) -> str | None:
        """Return the label in force, or None."""
        if self.intervals is not None:
            driver = match.driver
            return self.intervals.at(driver.log_time if self.recorded else driver.stamp)
        return None if match.label is None else self._value(match.label) or None

    def _scan(self, match: Match) -> Any:
        if match.scan is not None:
            return self._value(match.scan)
        self._missing("scan", match)
        return None

    def usable(self, item: Item) -> bool:
        """Tell whether a pose can be used; one that cannot is counted."""
        return self._value(item) is not None

    def _pose(self, match: Match) -> Pose2D | None:
        stamp, motion = match.driver.stamp, self.motion
        pose = self._joined(match)
        if motion is not None:
            alone = motion.from_transforms
            pose = motion.pose(stamp) if alone else motion.carried(pose, stamp)
        if pose is None:
            self._missing("pose", match)
        elif pose.frame != self._frame:
            if self._frame is not None:
                kind = "times poses change their frame, and with it all places"
                self.faults.add(kind, f"'{self._frame}' to '{pose.frame}' at stamp {stamp}")
            self._frame = pose.frame
        return pose

    def _joined(self, match: Match) -> Pose2D | None:
        values: list[Pose2D] = [item.value() for item in match.poses]
        if len(values) < 2:
            return values[0] if values else None
        first, second = (item.stamp for item in match.poses)
        share = (match.driver.stamp - first) / (second - first)
        if values[0].frame != values[1].frame:
            return values[round(share)]
        return interpolate(values[0], values[1], share)

    def _missing(self, part: Part, match: Match) -> None:
        if part in self.parts:
            kind = f"{self.driver}s have no {part} near enough in time"
            self.faults.add(kind, f"at stamp {match.driver.stamp}")

    def _value(self, item: Item) -> Any:
        try:
            return item.value()
        except UnusableObservation as error:
            # The same label or pose may be asked for at many observations.
            self.faults.add("messages could not be used", str(error), int(not item.spoilt))
            item.spoilt = True
            return None
