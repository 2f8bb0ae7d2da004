"""A copy of a log with a channel of labels."""

from __future__ import annotations

import logging
import struct
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from mcap.records import Attachment, McapRecord, Message, Metadata

from placecue.errors import UsageError
from placecue.logs.mcap import linear
from placecue.logs.mcap.container import LogFile
from placecue.logs.mcap.linear import Damage
from placecue.logs.messages import foxglove_messages, ros2_messages
from placecue.logs.messages.kinds import MessageType, Written
from placecue.logs.writing.output import Output, profile_of
from placecue.observation import Observation
from placecue.progress import track

log = logging.getLogger(__name__)

Event = tuple[int, str]


def label_events(observations: Iterable[Observation]) -> list[Event]:
    """Return where the label changes: the stamp, ns, and the new label, empty where one ends."""
    events: list[Event] = []
    label = ""
    for observation in observations:
        if (observation.label or "") != label:
            label = observation.label or ""
            events.append((observation.stamp, label))
    return events


def annotate(file: LogFile, events: Sequence[Event], out: str | Path, topic: str) -> int:
    """Copy a log, message by message and byte for byte, and add a channel of labels.

    The labels are messages of the kind that the log has: std_msgs/String in a log of ROS, whose
    log time is the time of the label, else placecue.Label. Attachments and metadata are copied
    too; how messages are packed into chunks is not.

    Parameters
    ----------
    file : LogFile
        An MCAP file.
    events : sequence of (int, str)
        Stamp, ns, and label from then on; see :func:`label_events`.
    out : str or Path
        The copy.
    topic : str
        Of the labels.

    Returns
    -------
    int
        Number of messages copied.

    Raises
    ------
    UsageError
        If the log has such a topic, or the copy would take its place or cannot be written.
    """
    names = [each.name for each in file.topics()]
    if topic in names:
        raise UsageError(f"{file.path} has a topic {topic} already; give another one with topic=")
    if Path(out).resolve() == file.path.resolve():
        raise UsageError(f"out={out} is the log itself; give the copy another name")
    waiting = sorted(events, reverse=True)
    encodings = {channel.message_encoding for channel in file.contents.channels.values()}
    copied = 0
    with Output(out, _profile(file, encodings)) as output:
        for record in track(_records(file), f"copying {file.path.name}"):
            if isinstance(record, Message):
                while waiting and waiting[-1][0] <= record.log_time:
                    output.write(waiting[-1][0], _label(topic, *waiting.pop(), encodings))
                output.copy(record, file.contents.channels, file.contents.schemas)
                copied += 1
            elif isinstance(record, Attachment):
                output.attach(record)
            elif isinstance(record, Metadata):
                output.metadata(record.name, record.metadata)
        for stamp, label in reversed(waiting):
            output.write(stamp, _label(topic, stamp, label, encodings))
    return copied


def _profile(file: LogFile, encodings: set[str]) -> str:
    """Return the profile of the copy: that of the log where labels and all else keep it true."""
    channels = file.contents.channels.values()
    return "" if "cdr" in encodings and not profile_of(channels) else file.contents.profile


def _records(file: LogFile) -> Iterator[McapRecord]:
    """Yield the records in the order of the file, and warn of what cannot be copied."""
    known: set[int] = set(file.contents.channels)
    told = list(file.contents.damages)  # when the file was opened
    found: list[Damage] = []
    with file.path.open("rb") as opened:
        for record in linear.records(opened, file.size, found.append, known):
            if not isinstance(record, Message) or record.channel_id in known:
                yield record
    if found and not told:
        log.warning(
            f"{file.path}: {len(found)} places are not copied, the first at byte "
            f"{found[0].offset} ({found[0].reason})"
        )


def _label(topic: str, stamp: int, label: str, encodings: set[str]) -> Written:
    if "cdr" in encodings:
        return Written(topic, ros2_messages.message_type("std_msgs/String"), {"data": label})
    if "ros1" in encodings:
        return Written(topic, ROS1_STRING, {"data": label})
    fields = {"stamp": stamp, "label": label}
    return Written(topic, foxglove_messages.message_type("placecue.Label"), fields)


def _ros1_string(message: dict[str, Any]) -> bytes:
    text: bytes = message["data"].encode()
    return struct.pack("<I", len(text)) + text


ROS1_STRING = MessageType("std_msgs/String", "ros1", "ros1msg", b"string data\n", _ros1_string)
