"""Depth images: told apart from pictures, and turned into scans where there is no laser."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import takewhile
from typing import Any

from placecue.depth import virtual_scan
from placecue.errors import ContractError, DataError, UnusableObservation
from placecue.guard import call
from placecue.logs.adapters import contract
from placecue.logs.adapters.lookup import adapter_for
from placecue.logs.joining.camera_info import CameraInfo, camera_info
from placecue.logs.joining.items import TopicReader
from placecue.logs.mcap.container import LogFile, Topic
from placecue.logs.messages.decoders import decoder_for
from placecue.logs.messages.geometry import Transform
from placecue.logs.messages.images import DEPTH_FORMATS, RawImage
from placecue.observation import LaserScan

CAMERA_INFO = "sensor_msgs/CameraInfo"
CALIBRATION = "foxglove.CameraCalibration"
#: A camera looks along z with x to the right; from there to x ahead and y to the left.
AHEAD = (0.5, -0.5, 0.5, 0.5)


def marked(file: LogFile) -> list[Topic]:
    """Return the topics of a log, with those of depth images marked.

    The pixel format stands in the messages and not in the schema, so the first message of each
    topic of images is looked at.
    """
    return [replace(topic, depth=_is_depth(file, topic)) for topic in file.topics()]


def _is_depth(file: LogFile, topic: Topic) -> bool:
    adapter = adapter_for(topic.encoding, topic.schema)
    if adapter is None or adapter.role != "image" or topic.count == 0:
        return False
    pixels = _first(file, topic, partial(call, adapter, "pixels", check=contract.text)) or ""
    name = pixels.lower().partition(";")[0].strip()
    deep = name == "mono16" and "depth" in topic.name.lower()
    return deep or name in DEPTH_FORMATS or "compresseddepth" in pixels.lower()


def _first(file: LogFile, topic: Topic, read: Callable[[Any], Any]) -> Any:
    """Return what is read of the first message that can be read, or None."""
    contents = file.contents
    for message in file.messages(topic.channels):
        channel = contents.channels[message.channel_id]
        try:
            decode = decoder_for(channel, contents.schemas.get(channel.schema_id))
            return read(decode(message.data))
        except DataError:
            return None  # said when the topic is read
        except ContractError:
            raise
        except Exception:  # decoders raise anything over damaged bytes
            continue
    return None


def looking_ahead(frame: str) -> Transform:
    """Return the transform from a camera's own frame to one that looks along x."""
    return Transform(frame, f"{frame} (scan)", (0.0, 0.0, 0.0), AHEAD)


class DepthReader(TopicReader):
    """Takes virtual scans out of depth images.

    Parameters
    ----------
    file : LogFile
        The log.
    topic : Topic
        One with depth images.
    topics : sequence of Topic
        All of the log; the camera's intrinsics are taken from the one with the most alike name.
    place : callable
        Applied to each scan and its time: the mounting of the camera.

    Raises
    ------
    DataError
        If the log has no intrinsics, or the messages cannot be decoded.
    """

    def __init__(
        self,
        file: LogFile,
        topic: Topic,
        topics: Sequence[Topic],
        place: Callable[[LaserScan, int], LaserScan],
    ) -> None:
        self.camera = _camera(file, topic, topics)
        super().__init__(file, topic, lambda image, stamp: place(self._scan(image), stamp))
        self.role = "scan"

    def _scan(self, image: Any) -> LaserScan:
        if not isinstance(image, RawImage):
            raise UnusableObservation(
                f"{self.topic.name} holds compressed depth images, which are not read"
            )
        depth = image.depth()
        return virtual_scan(depth, self.camera.of_image(depth.shape[1], depth.shape[0]))


def _camera(file: LogFile, topic: Topic, topics: Sequence[Topic]) -> CameraInfo:
    cameras = [each for each in topics if _kind(each) in (CAMERA_INFO, CALIBRATION)]
    cameras.sort(key=lambda each: _alike(each.name, topic.name), reverse=True)
    for camera in cameras:
        found = _first(file, camera, camera_info)
        if found is not None:
            described: CameraInfo = found
            return described
    raise DataError(
        f"{file.path}: {topic.name} holds depth images but no topic the intrinsics of their "
        f"camera ({CAMERA_INFO} or {CALIBRATION}), so they give no scan: read the log without "
        "scans, source.parts=[image,pose,label]"
    )


def _alike(one: str, other: str) -> int:
    """Return how many steps two names have in common at their beginning."""
    steps = zip(one.split("/"), other.split("/"), strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], steps))


def _kind(topic: Topic) -> str:
    return topic.schema.replace("/msg/", "/")
