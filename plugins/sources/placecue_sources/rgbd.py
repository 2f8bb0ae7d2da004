"""Colour and depth images: pictures, and a virtual laser scan cut from the depth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path

import numpy as np

from placecue.checks import check_choice, check_number, check_whole
from placecue.depth import Intrinsics, virtual_scan
from placecue.errors import UnusableObservation, UsageError
from placecue.observation import LaserScan, Observation, Pose2D
from placecue.source import Source
from placecue_sources.contents import digest_of
from placecue_sources.rgbd_cuts import cut_into_scenes
from placecue_sources.rgbd_files import Parts, depth_image, picture
from placecue_sources.rgbd_frames import (
    Columns,
    Frame,
    frames_of_folders,
    frames_of_table,
    select,
)

#: What the parameter ``parts`` may name; there are no poses, and labels are always given.
PARTS = ("image", "scan", "pose", "label")


class RGBD(Source):
    """A data set of colour and depth images: each frame gives a picture and a virtual laser scan.

    The frames are those of a table (``labels``), or the files of two folders paired by their
    names. They are single frames and not a drive: none has a pose. Parts that are missing or
    cannot be read are left out of their frame, counted, and reported once.

    Parameters
    ----------
    path : str
        The folder of the data set.
    labels : str, optional
        CSV file in it with a line for each frame; without it there are no labels.
    image_column, depth_column : str, optional
        Columns with the paths of the files, relative to the table.
    label_column : str, optional
        Column with the place.
    stamp_column : str, optional
        Column with the time, s. By default frame n has the time n / rate.
    scene_column : str, optional
        Column with the scene that a frame belongs to, such as one visit of one room.
    cuts : list of float, or str, optional
        In place of such a column: the times at which scenes begin, s; or ``nyuv2``, which has
        those of the labelled frames of NYU Depth v2, numbered from 0.
    images, depths : str
        Folders in it, where there is no table.
    rate : float
        Frames a second, where no column gives the time.
    classes : list of str, optional
        Keep only frames of these classes.
    min_frames : int
        Leave out classes with fewer frames.
    parts : list of str, optional
        What to read, of image and scan; both by default.
    depth_scale : float
        Length of one unit of the depth images, m. A Kinect's are 16 bit in mm.
    fx, cx, cy : float
        Focal length and optical axis of the depth camera, pixels. The defaults are a Kinect's.
    band : int
        Rows around the horizon that the scan is cut from.
    horizon : float, optional
        Row of the horizon; that of the optical axis by default.
    percentile : float
        Which depth of a column is taken, of those in the band: a low one, so that a few wrong
        pixels do no harm.
    min_valid : float
        Share of the band's rows that must be valid in a column.
    step : float
        Angle between beams, degrees.
    range_min, range_max : float
        Limits of the scan, m.
    mount : sequence of 3 floats
        Where the camera sits on the robot: x and y, m, and its heading, degrees.

    See Also
    --------
    placecue.depth.virtual_scan : how the scan is cut.
    """

    def __init__(
        self,
        path: str,
        labels: str | None = None,
        image_column: str | None = "rgb",
        depth_column: str | None = "depth",
        label_column: str | None = "label",
        stamp_column: str | None = None,
        scene_column: str | None = None,
        cuts: Sequence[float] | str | None = None,
        images: str = "rgb",
        depths: str = "depth",
        rate: float = 1.0,
        classes: Sequence[str] | None = None,
        min_frames: int = 0,
        parts: Sequence[str] | None = None,
        depth_scale: float = 0.001,
        fx: float = 525.0,
        cx: float = 319.5,
        cy: float = 239.5,
        band: int = 60,
        horizon: float | None = None,
        percentile: float = 5.0,
        min_valid: float = 0.1,
        step: float = 0.5,
        range_min: float = 0.0,
        range_max: float = 10.0,
        mount: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        self.path = path
        self.labels = labels
        self.image_column = image_column
        self.depth_column = depth_column
        self.label_column = label_column
        self.stamp_column = stamp_column
        self.scene_column = scene_column
        self.cuts = cuts
        self.images = images
        self.depths = depths
        self.rate = rate
        self.classes = classes
        self.min_frames = min_frames
        self.parts = parts
        self.depth_scale = depth_scale
        self.fx = fx
        self.cx = cx
        self.cy = cy
        self.band = band
        self.horizon = horizon
        self.percentile = percentile
        self.min_valid = min_valid
        self.step = step
        self.range_min = range_min
        self.range_max = range_max
        self.mount = mount

    @property
    def name(self) -> str:  # type: ignore[override]
        """The folder's name."""
        return Path(self.path).expanduser().resolve().name

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """What it is, and how its scans were made."""
        return {
            "format": "RGB-D frames",
            "frames": "single frames, not a drive",
            "scan": f"virtual, cut from {self.band} rows of the depth image",
            "camera": f"fx {self.fx:g}, cx {self.cx:g}, cy {self.cy:g} pixels",
            "depth": f"{self.depth_scale:g} m a unit",
        }

    def __iter__(self) -> Iterator[Observation]:
        parts = Parts(self.path, len(self._frames))
        image, scan = self._read("image"), self._read("scan")
        for frame in self._frames:
            yield Observation(
                frame.stamp,
                image=parts.tried(picture, frame) if image else None,
                scan=parts.tried(self._scan, frame) if scan else None,
                label=frame.label,
                scene=frame.scene,
            )
        parts.report()

    def count(self) -> int:
        """Return the number of frames."""
        return len(self._frames)

    def digest(self) -> str:
        """Return a digest of the files and of the parameters, but for which parts are read."""
        own = ("path", "parts", "scene_column", "cuts", "_frames")
        parameters = {name: value for name, value in vars(self).items() if name not in own}
        files = [(frame.image, frame.depth) for frame in self._frames]
        there = [[path is not None and path.is_file() for path in pair] for pair in files]
        parameters["frames"] = [(frame.stamp, frame.label, frame.scene) for frame in self._frames]
        parameters["there"] = there
        paths = [path for pair in files for path in pair if path is not None and path.is_file()]
        return digest_of(parameters, paths)

    @cached_property
    def _frames(self) -> list[Frame]:
        """The frames, as the table or the folders have them."""
        self._check()
        folder = Path(self.path).expanduser()
        if not folder.is_dir():
            raise UsageError(f"there is no folder {self.path}; check the path")
        if self.labels is None:
            found = frames_of_folders(folder / self.images, folder / self.depths, self.rate)
        else:
            columns = Columns(
                self.image_column,
                self.depth_column,
                self.label_column,
                self.stamp_column,
                self.scene_column,
            )
            found = frames_of_table(folder / self.labels, columns, self.rate)
        if self.cuts is not None:
            found = cut_into_scenes(found, self.cuts)
        return select(found, self.classes, self.min_frames, self.path)

    def _read(self, part: str) -> bool:
        """Tell whether a part is wanted, and there for at least one frame."""
        if self.parts is not None and part not in self.parts:
            return False
        return any((each.image if part == "image" else each.depth) for each in self._frames)

    def _scan(self, frame: Frame) -> LaserScan:
        depth = depth_image(frame) * self.depth_scale
        x, y, heading = self.mount
        try:
            return virtual_scan(
                depth,
                Intrinsics(self.fx, self.cx, self.cy),
                band=self.band,
                horizon=self.horizon,
                percentile=self.percentile,
                min_valid=self.min_valid,
                step=self.step,
                range_min=self.range_min,
                range_max=self.range_max,
                mount=Pose2D(x, y, float(np.deg2rad(heading)), "base_link"),
            )
        except UnusableObservation as error:
            raise UnusableObservation(f"{frame.depth}: {error}") from error

    def _check(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        for part in PARTS if self.parts is None else self.parts:
            check_choice("parts", part, PARTS)
        for name in ("rate", "depth_scale", "fx", "step", "range_max"):
            check_number(name, getattr(self, name), above=0)
        for name in ("cx", "cy", "percentile", "min_valid", "range_min"):
            check_number(name, getattr(self, name), least=0)
        for name, most in (("percentile", 100), ("min_valid", 1)):
            if getattr(self, name) > most:
                raise UsageError(f"{name} is {getattr(self, name)}; give a number from 0 to {most}")
        check_whole("band", self.band, least=1)
        check_whole("min_frames", self.min_frames, least=0)
        if self.cuts is not None and self.scene_column is not None:
            raise UsageError("cuts and scene_column both tell scenes: give one of them")
        if len(self.mount) != 3:
            raise UsageError(f"mount is {list(self.mount)}; give x, y (m) and heading (degrees)")
