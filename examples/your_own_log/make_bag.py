"""Turns a simulated drive into a ROS 2 bag without labels, as a robot would record it.

python make_bag.py run1.mcap run1_bag
"""

from __future__ import annotations

import sys
from pathlib import Path

from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer

LEFT_OUT = ("/label",)


def main(log: Path, bag: Path) -> None:
    """Copy every topic but the labels, byte for byte."""
    with (
        AnyReader([log]) as reader,
        Writer(bag, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer,
    ):
        copies = {
            each.id: writer.add_connection(each.topic, each.msgtype, typestore=reader.typestore)
            for each in reader.connections
            if each.topic not in LEFT_OUT
        }
        for connection, stamp, data in reader.messages():
            if connection.id in copies:
                writer.write(copies[connection.id], stamp, data)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:3]))
