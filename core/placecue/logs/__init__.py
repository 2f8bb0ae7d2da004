"""Logs: MCAP in, MCAP out. ROS is not needed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from placecue.components.hooks import Component, hookimpl

if TYPE_CHECKING:
    from placecue.logs.reader import McapLog, open_log

__all__ = ["McapLog", "open_log", "placecue_components"]


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="source",
            name="mcap",
            factory="placecue.logs.reader:McapLog",
            summary="MCAP log: ROS 1, ROS 2 or Foxglove messages",
            requires=("path",),
            recognise="placecue.logs.recognise:mcap",
        ),
        Component(
            kind="source",
            name="rosbag",
            factory="placecue.logs.rosbag:RosbagLog",
            summary="ROS 1 or ROS 2 bag (.bag, sqlite3)",
            requires=("path",),
            recognise="placecue.logs.recognise:rosbag",
        ),
        Component(
            kind="source",
            name="foxglove",
            factory="placecue.logs.live.log:LiveLog",
            summary="a robot while it drives, over Foxglove's WebSocket protocol (placecue live)",
            requires=("path",),
        ),
    ]


def __getattr__(name: str) -> Any:
    if name in {"McapLog", "open_log"}:
        from placecue.logs import reader

        return getattr(reader, name)
    raise AttributeError(f"module 'placecue.logs' has no attribute '{name}'")
