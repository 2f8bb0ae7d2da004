"""Observations into an MCAP file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from placecue.camera import PinholeCamera
from placecue.errors import UnusableObservation, UsageError, choices
from placecue.logs.messages.foxglove_messages import FoxgloveDialect
from placecue.logs.messages.kinds import (
    BASE_FRAME,
    LASER_FRAME,
    ODOM_FRAME,
    Dialect,
    Written,
    spacing,
)
from placecue.logs.messages.ros2_messages import Ros2Dialect
from placecue.logs.writing.output import Output
from placecue.observation import EncodedImage, LaserScan, Observation, Pose2D

DIALECTS: dict[str, type[Dialect]] = {"cdr": Ros2Dialect, "json": FoxgloveDialect}
IMAGE_FORMATS = ("jpeg", "png")
#: Beams whose spacing differs from the mean by more than this share of it are not even.
EVEN = 0.01
#: Stamps from here on do not fit into the 32-bit seconds of messages, ns.
LAST_STAMP = 2**31 * 10**9


def can_hold(stamp: int) -> bool:
    """Tell whether messages can hold a stamp, ns."""
    return 0 <= stamp < LAST_STAMP


def is_finite(pose: Pose2D) -> bool:
    """Tell whether a pose is made of finite numbers."""
    return bool(np.isfinite([pose.x, pose.y, pose.theta]).all())


class McapWriter:
    """Writes observations to an MCAP file; a context manager.

    The file appears when the block ends well; when it does not, nothing is left behind.
    Messages: a compressed image, a scan, a pose (also as a transform, for viewers), the laser's
    mounting as a static transform, and an event whenever the label changes. Where poses were
    corrected, the transforms are those of ROS: ``map → odom`` and ``odom → base_link``. Stamps are
    exact; encoded images pass through untouched; poses keep every bit of x and y, headings come
    back within [-pi, pi]. In ``cdr`` the ranges and angles of scans are rounded to float32.

    Parameters
    ----------
    path : str or Path
        The file to be.
    encoding : {"cdr", "json"}
        ROS 2 messages, which ROS 2 tools play, or Foxglove's in JSON.
    image_format : {"jpeg", "png"}
        For images that are not encoded yet.
    image_quality : int
        Quality of JPEG, 1 to 100.
    compression : {"zstd", "lz4", "none"}
        Of the chunks.
    chunk_size : int
        Bytes of messages in a chunk, before compression.
    metadata : mapping of str to str, optional
        Conditions of the recording, kept in the metadata record ``placecue``.
    camera : PinholeCamera, optional
        Written beside each image, as sensor_msgs/CameraInfo or foxglove.CameraCalibration.
    profile : str, optional
        Profile of the file, where it will hold other things too.

    Raises
    ------
    UsageError
        If the file cannot be written there, or an option is not known.

    Examples
    --------
    >>> with McapWriter("run.mcap") as writer:  # doctest: +SKIP
    ...     writer.write(observation)
    """

    def __init__(
        self,
        path: str | Path,
        encoding: str = "cdr",
        image_format: str = "jpeg",
        image_quality: int = 90,
        compression: str = "zstd",
        chunk_size: int = 2**20,
        metadata: Mapping[str, str] | None = None,
        camera: PinholeCamera | None = None,
        profile: str | None = None,
    ) -> None:
        if encoding not in DIALECTS:
            raise UsageError(f"unknown encoding '{encoding}': {choices(encoding, DIALECTS)}")
        if image_format not in IMAGE_FORMATS:
            raise UsageError(
                f"unknown image format '{image_format}': {choices(image_format, IMAGE_FORMATS)}"
            )
        self.image_format = image_format
        self.image_quality = image_quality
        self.dialect = DIALECTS[encoding]()
        self.output = Output(
            path, self.dialect.profile if profile is None else profile, compression, chunk_size
        )
        self.camera = camera
        self._label: str | None = None
        self._mount: Pose2D | None = None
        self._odometry: Pose2D | None = None  # the last
        if metadata:
            self.output.metadata("placecue", metadata)

    def write(self, observation: Observation) -> None:
        """Write one observation, all of it or nothing.

        Raises
        ------
        UnusableObservation
            If its image does not decode, its beams are not evenly spaced, its pose is not finite,
            or its stamp is before 1970 or after 2038.
        """
        stamp = observation.stamp
        if not can_hold(stamp):
            raise UnusableObservation(f"stamp {stamp} is not between 1970 and 2038")
        label, mount = observation.label or "", None
        messages: list[Written] = []
        if label != (self._label or ""):
            messages.append(self.dialect.label(stamp, label))
        if observation.pose is not None:
            messages += self._pose(stamp, observation.pose, observation.odometry)
        if observation.scan is not None:
            mount = observation.scan.mount
            messages += self._scan(stamp, observation.scan)
        if observation.image_source is not None:
            messages.append(self._image(observation))
            if self.camera is not None:
                messages.append(self.dialect.camera(stamp, self.camera))
        for message in messages:
            self.output.write(stamp, message)
        self._label, self._mount = label, mount or self._mount

    def _pose(self, stamp: int, pose: Pose2D, odometry: Pose2D | None) -> list[Written]:
        if not is_finite(pose):
            raise UnusableObservation(f"the pose at stamp {stamp} is not finite: {pose}")
        if odometry is not None and is_finite(odometry):
            self._odometry = odometry
        told = [self.dialect.pose(stamp, pose)]
        parent, moved = pose.frame, pose
        if self._odometry is not None:
            parent = ODOM_FRAME if self._odometry.frame == pose.frame else self._odometry.frame
            drift = pose.compose(self._odometry.inverse())
            told.append(self.dialect.transform(stamp, pose.frame, parent, drift, static=False))
            moved = self._odometry
        return [*told, self.dialect.transform(stamp, parent, BASE_FRAME, moved, static=False)]

    def _scan(self, stamp: int, scan: LaserScan) -> list[Written]:
        uneven = np.abs(np.diff(scan.angles) - spacing(scan)) > EVEN * abs(spacing(scan))
        if uneven.any() or not np.isfinite(scan.angles).all():
            raise UnusableObservation(
                f"the {len(scan.angles)} beams at stamp {stamp} are not evenly spaced, which no "
                "scan message can hold: resample them"
            )
        written = [self.dialect.scan(stamp, scan)]
        if scan.mount != self._mount:
            mounted = self.dialect.transform(
                stamp, BASE_FRAME, LASER_FRAME, scan.mount, static=True
            )
            written.insert(0, mounted)
        return written

    def _image(self, observation: Observation) -> Written:
        source = observation.image_source
        if isinstance(source, EncodedImage):
            return self.dialect.image(observation.stamp, source.data, source.format)
        import cv2

        image = observation.image
        assert image is not None  # there is a source
        pixels = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2BGR)
        jpeg = self.image_format == "jpeg"
        options = [cv2.IMWRITE_JPEG_QUALITY, self.image_quality] if jpeg else []
        _, data = cv2.imencode(".jpg" if jpeg else ".png", pixels, options)
        return self.dialect.image(observation.stamp, data.tobytes(), self.image_format)

    def close(self) -> None:
        """Finish the file and give it its name."""
        self.output.commit()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None:
            self.close()
        else:
            self.output.abort()
