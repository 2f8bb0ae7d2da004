"""A ROS 1 or ROS 2 bag as a source of observations."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from placecue.logs.bags.bag import BagFile
from placecue.logs.mcap.container import LogFile
from placecue.logs.reader import McapLog


class RosbagLog(McapLog):
    """One ROS bag, read as an MCAP log with the same messages would be.

    Parameters
    ----------
    path : str
        A ROS 1 bag (``.bag``), the folder of a ROS 2 bag, or its storage file (``.db3``).
    distribution : str
        ROS 2 distribution whose message definitions stand in where the bag has none, as sqlite3
        bags before Iron: foxy, galactic, humble, iron, jazzy and so on.
    image_topic, scan_topic, pose_topic, label_topic, labels, parts, tolerance, window, pose_gap, \
base_frame, laser_frame, pose_frame, range_max, transform_horizon, start, end
        See :class:`McapLog`.
    """

    def __init__(
        self,
        path: str,
        distribution: str = "humble",
        image_topic: str | None = None,
        scan_topic: str | None = None,
        pose_topic: str | None = None,
        label_topic: str | None = None,
        labels: str | None = None,
        parts: Sequence[str] | None = None,
        tolerance: float = 0.1,
        window: float = 1.0,
        pose_gap: float = 1.0,
        base_frame: str | None = None,
        laser_frame: str | None = None,
        pose_frame: str | None = None,
        range_max: float = 30.0,
        transform_horizon: float = 10.0,
        start: float | None = None,
        end: float | None = None,
    ) -> None:
        super().__init__(
            path,
            image_topic=image_topic,
            scan_topic=scan_topic,
            pose_topic=pose_topic,
            label_topic=label_topic,
            labels=labels,
            parts=parts,
            tolerance=tolerance,
            window=window,
            pose_gap=pose_gap,
            base_frame=base_frame,
            laser_frame=laser_frame,
            pose_frame=pose_frame,
            range_max=range_max,
            transform_horizon=transform_horizon,
            start=start,
            end=end,
        )
        self.distribution = distribution

    @cached_property
    def file(self) -> LogFile:
        """The bag and what it holds."""
        return BagFile(self.path, self.distribution)
