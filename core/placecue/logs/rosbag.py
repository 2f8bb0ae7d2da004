"""A ROS 1 or ROS 2 bag as a source of observations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from placecue.logs.bags.bag import BagFile
from placecue.logs.mcap.container import LogFile
from placecue.logs.reader import McapLog


@dataclass(eq=False, repr=False)
class RosbagLog(McapLog):
    """One ROS bag, read as an MCAP log with the same messages would be.

    Parameters
    ----------
    path : str
        A ROS 1 bag (``.bag``), the folder of a ROS 2 bag, or its storage file (``.db3``).
    image_topic, scan_topic, pose_topic, label_topic, labels, parts, tolerance, window, pose_gap, \
silence, base_frame, laser_frame, pose_frame, range_max, transform_horizon, start, end
        See :class:`LogOptions`.
    distribution : str
        ROS 2 distribution whose message definitions stand in where the bag has none, as sqlite3
        bags before Iron: foxy, galactic, humble, iron, jazzy and so on.
    """

    distribution: str = "humble"

    @cached_property
    def file(self) -> LogFile:
        """The bag and what it holds."""
        return BagFile(self.path, self.distribution)
