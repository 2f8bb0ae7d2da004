"""How files of logs are known."""

from __future__ import annotations

from placecue.recognition import Found

MAGIC = b"\x89MCAP0\r\n"
BAGS = (b"#ROSBAG", b"SQLite format 3")


def mcap(found: Found) -> int:
    """Tell whether this is an MCAP file."""
    if found.head.startswith(MAGIC):
        return Found.BY_CONTENT
    return Found.BY_SHAPE if found.suffix == ".mcap" else Found.NOT_AT_ALL


def rosbag(found: Found) -> int:
    """Tell whether this is a ROS bag: a .bag file, or a storage file or the folder of one.

    A recorder that was killed leaves a folder without metadata.
    """
    stored = any(
        name.endswith(".db3") or (name.endswith(".mcap") and "/" not in name)
        for name in found.names
    )
    if found.head.startswith(BAGS) or stored:
        return Found.BY_CONTENT
    return Found.BY_SHAPE if found.suffix in (".bag", ".db3") else Found.NOT_AT_ALL
