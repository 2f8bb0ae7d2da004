"""One moment of a log: what the robot saw, where it was, and what the place is called."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Never, TypeAlias

import numpy as np
from numpy.typing import NDArray

from placecue.decoding import decoded
from placecue.errors import FOREIGN, PlacecueError, UnusableObservation, described, told
from placecue.read_only import read_only

if TYPE_CHECKING:
    from placecue.correction import Correction

Image: TypeAlias = NDArray[np.uint8]
Part = Literal["image", "scan", "pose", "label"]
#: Goes up when the same log gives other observations, so that features of before are not taken.
READING = 2
PARTS: tuple[Part, ...] = ("image", "scan", "pose", "label")


@dataclass(frozen=True, slots=True)
class Pose2D:
    """A position and heading in the plane.

    Parameters
    ----------
    x, y : float
        Position, m.
    theta : float
        Heading, rad, counter-clockwise from the x axis.
    frame : str
        The frame that the pose is given in, such as ``odom`` or ``map``.
    """

    x: float
    y: float
    theta: float
    frame: str = "odom"

    def compose(self, other: Pose2D) -> Pose2D:
        """Return ``other``, given in this pose's own frame, in the frame of this pose."""
        c, s = np.cos(self.theta), np.sin(self.theta)
        return Pose2D(
            x=float(self.x + c * other.x - s * other.y),
            y=float(self.y + s * other.x + c * other.y),
            theta=self.theta + other.theta,
            frame=self.frame,
        )

    def inverse(self, frame: str = "base_link") -> Pose2D:
        """Return where this pose's frame lies, seen from this pose, whose own frame is named."""
        c, s = np.cos(self.theta), np.sin(self.theta)
        x, y = float(-c * self.x - s * self.y), float(s * self.x - c * self.y)
        return Pose2D(x, y, -self.theta, frame)


@dataclass(frozen=True, slots=True)
class LaserScan:
    """One sweep of a 2D laser scanner. Nothing can be written into it.

    Parameters
    ----------
    angles : ndarray of float64, shape (n,)
        Direction of each beam in the scanner's frame, rad, increasing, counter-clockwise.
    ranges : ndarray of float64, shape (n,)
        Length of each beam, m. NaN, infinite, and lengths outside (range_min, range_max] are
        invalid: nothing was measured there.
    range_min, range_max : float
        The scanner's limits, m.
    mount : Pose2D
        Where the scanner sits on the robot.
    """

    angles: NDArray[np.float64]
    ranges: NDArray[np.float64]
    range_min: float
    range_max: float
    mount: Pose2D = field(default=Pose2D(0.0, 0.0, 0.0, "base_link"))

    def __post_init__(self) -> None:
        object.__setattr__(self, "angles", read_only(self.angles))
        object.__setattr__(self, "ranges", read_only(self.ranges))

    def __reduce__(self) -> tuple[Any, ...]:
        # Copies and what comes from another process are read-only again.
        parts = (self.angles, self.ranges, self.range_min, self.range_max, self.mount)
        return LaserScan, parts

    def valid(self) -> NDArray[np.bool_]:
        """Return which beams measured something, shape (n,)."""
        with np.errstate(invalid="ignore"):
            within = (self.ranges > self.range_min) & (self.ranges <= self.range_max)
        return within & np.isfinite(self.ranges)

    def filled(self) -> NDArray[np.float64]:
        """Return the ranges with every invalid beam set to ``range_max``.

        Returns
        -------
        ndarray of float64, shape (n,)
            Ranges, m.

        Raises
        ------
        UnusableObservation
            If the scan has no beams or no valid one.
        """
        if self.ranges.size == 0:
            raise UnusableObservation("the laser scan is empty (0 beams)")
        valid = self.valid()
        if not valid.any():
            raise UnusableObservation(
                f"none of the {self.ranges.size} beams of the laser scan is valid "
                f"(all NaN, infinite or outside {self.range_min:g} to {self.range_max:g} m)"
            )
        return np.where(valid, self.ranges, self.range_max)

    def scaled(self, factor: float) -> LaserScan:
        """Return what the same scanner would measure if the surroundings were larger by a factor.

        What comes to lie beyond the scanner's range is invalid, as it would be.
        """
        closest = np.nextafter(self.range_min, np.inf)
        larger = np.maximum(self.ranges * factor, closest)
        return replace(self, ranges=np.where(self.valid(), larger, self.ranges))

    def points(self) -> NDArray[np.float64]:
        """Return the end points of the valid beams in the robot's frame, m, shape (k, 2)."""
        valid = self.valid()
        bearing = self.angles[valid] + self.mount.theta
        offset = np.array([self.mount.x, self.mount.y])
        direction = np.column_stack([np.cos(bearing), np.sin(bearing)])
        return np.asarray(offset + self.ranges[valid, None] * direction)


@dataclass(frozen=True, slots=True)
class EncodedImage:
    """An image as it lies in a log, decoded when called.

    Parameters
    ----------
    data : bytes
        The encoded image.
    format : str
        ``jpeg`` or ``png``.
    origin : str
        Where it comes from, for messages.
    """

    data: bytes
    format: str = "jpeg"
    origin: str = "image"

    def __call__(self) -> Image:
        """Decode to RGB (H, W, 3), or to grey (H, W) where the file is grey.

        Raises
        ------
        UnusableObservation
            If the bytes are not an image.
        """
        image = decoded(self.data, self.origin)
        if image.ndim == 3:
            import cv2

            image = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), dtype=np.uint8)
        return image


class Recording:
    """Which log an observation is of.

    Parameters
    ----------
    name : str
        What it is called.
    digest : str or callable
        Digest of its content, or what returns it, called when somebody asks: it reads the log.
    """

    def __init__(self, name: str, digest: str | Callable[[], str]) -> None:
        self.name = name
        self._digest = digest

    @property
    def digest(self) -> str:
        """Digest of the content."""
        if callable(self._digest):
            self._digest = self._digest()
        return self._digest

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Recording) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    def __reduce__(self) -> tuple[Any, ...]:
        return Recording, (self.name, self.digest)


class Origin(NamedTuple):
    """Which observation of which log something is.

    Parameters
    ----------
    recording : Recording
        The log.
    number : int
        Which of its observations, from 0.
    altered : str
        What was done to it for training; empty for what was recorded.
    """

    recording: Recording
    number: int
    altered: str = ""

    @property
    def log(self) -> str:
        """Digest of the log."""
        return self.recording.digest


class Observation:
    """One moment of a log. Any part but the stamp may be missing.

    It is read-only, its arrays too: what one component wrote into it, all others would see.

    Parameters
    ----------
    stamp : int
        Time of the measurement, ns.
    image : ndarray of uint8, shape (H, W, 3) or (H, W), callable, or None
        RGB or grey image, or something that decodes one when called, such as an
        :class:`EncodedImage`. It is called on the first use of ``image``, so a laser-only
        pipeline never decodes a picture.
    scan : LaserScan or None
        The laser scan nearest in time.
    pose : Pose2D or None
        Where the robot was.
    label : str or None
        The true name of the place, where somebody gave one.
    origin : Origin or None
        Where it comes from, so that its features can be kept between runs; a source's own
        observations always know.
    log_name : str
        What to call the log it is of, in messages.
    scene : str or None
        Which part of the log it belongs to, where a source knows: one visit of one room, say.
        Observations of one scene are near-copies, so the folds ``scenes`` never part them.
    correction : Correction or None
        How poses of earlier observations have moved, where that was learned just now.
    odometry : Pose2D or None
        The pose as it was recorded, where ``pose`` is a corrected one.
    """

    __slots__ = (
        "_decoded",
        "correction",
        "image_source",
        "label",
        "log_name",
        "odometry",
        "origin",
        "pose",
        "scan",
        "scene",
        "stamp",
    )

    stamp: int
    image_source: Image | Callable[[], Image] | None
    scan: LaserScan | None
    pose: Pose2D | None
    label: str | None
    origin: Origin | None
    log_name: str
    scene: str | None
    correction: Correction | None
    odometry: Pose2D | None
    _decoded: Image | None

    def __init__(
        self,
        stamp: int,
        *,
        image: Image | Callable[[], Image] | None = None,
        scan: LaserScan | None = None,
        pose: Pose2D | None = None,
        label: str | None = None,
        origin: Origin | None = None,
        log_name: str = "",
        scene: str | None = None,
        correction: Correction | None = None,
        odometry: Pose2D | None = None,
    ) -> None:
        keep = partial(object.__setattr__, self)
        keep("stamp", stamp)
        keep("image_source", read_only(image) if isinstance(image, np.ndarray) else image)
        keep("scan", scan)
        keep("pose", pose)
        keep("label", label)
        keep("origin", origin)
        keep("log_name", log_name)
        keep("scene", scene)
        keep("correction", correction)
        keep("odometry", odometry)
        keep("_decoded", None)

    def __setattr__(self, name: str, value: object) -> Never:
        raise AttributeError(
            f"observations are read-only, so {name} cannot be set: make a copy with altered() or "
            "relabelled()"
        )

    def __delattr__(self, name: str) -> Never:
        raise AttributeError(f"observations are read-only, so {name} cannot be deleted")

    @property
    def image(self) -> Image | None:
        """The image, decoded on first use; None where there is none.

        Raises
        ------
        UnusableObservation
            If it does not decode, or not to an image.
        """
        if self._decoded is None and self.image_source is not None:
            source = self.image_source
            image = self._called(source) if callable(source) else source
            object.__setattr__(self, "_decoded", self._checked(image))
        return self._decoded

    def _called(self, source: Callable[[], Image]) -> Image:
        try:
            return source()
        except PlacecueError:
            raise
        except FOREIGN as error:
            raise UnusableObservation(
                f"{self._its('image')} does not decode: {told(error)}"
            ) from error

    def _checked(self, image: Any) -> Image:
        # What pixels it must have, the cues say.
        if not isinstance(image, np.ndarray):
            raise UnusableObservation(f"{self._its('image')} is {described(image)}, not an array")
        return read_only(image)

    def _its(self, part: Part) -> str:
        return f"the {part} at stamp {self.stamp}{f' of {self.log_name}' if self.log_name else ''}"

    def has(self, part: Part) -> bool:
        """Tell whether a part is there, without decoding it."""
        return getattr(self, "image_source" if part == "image" else part) is not None

    def require(self, parts: tuple[Part, ...]) -> None:
        """Raise UnusableObservation unless every one of ``parts`` is there."""
        missing = [part for part in parts if not self.has(part)]
        if missing:
            raise UnusableObservation(f"no {' and no '.join(missing)} at stamp {self.stamp}")

    def relabelled(self, label: str | None) -> Observation:
        """Return the same moment under another label; a pending image stays undecoded."""
        return self._with(label=label)

    def placed(self, pose: Pose2D | None, correction: Correction | None = None) -> Observation:
        """Return the same moment at another pose; a pending image stays undecoded.

        Parameters
        ----------
        pose : Pose2D or None
            Where the robot was, as it is known better now.
        correction : Correction, optional
            How the poses of earlier observations have moved.
        """
        recorded = self.odometry or self.pose
        return self._with(pose=pose, correction=correction, odometry=recorded)

    def of_log(self, name: str, origin: Origin | None = None) -> Observation:
        """Say what the log is called and which of its observations this is, unless that is known.

        Returns the observation itself.
        """
        if not self.log_name:
            object.__setattr__(self, "log_name", name)
        if self.origin is None:
            object.__setattr__(self, "origin", origin)
        return self

    def altered(self, how: str, **parts: Any) -> Observation:
        """Return a copy for training, with other parts.

        Parameters
        ----------
        how : str
            What was done, such as ``scaled by 0.8``; another alteration has another name.
        **parts
            ``image`` or ``scan``, in place of what was recorded.
        """
        return self._with(origin=self.origin and self.origin._replace(altered=how), **parts)

    def _with(self, **changed: Any) -> Observation:
        return Observation(self.stamp, **(self._parts() | changed))

    def _parts(self) -> dict[str, Any]:
        names = ("scan", "pose", "label", "origin", "log_name", "scene", "correction", "odometry")
        return {"image": self.image_source} | {name: getattr(self, name) for name in names}

    def __reduce__(self) -> tuple[Any, ...]:
        # Copies and what comes from another process are read-only again.
        return partial(Observation, **self._parts()), (self.stamp,)

    def __repr__(self) -> str:
        parts = ", ".join(part for part in PARTS if self.has(part))
        return f"Observation(stamp={self.stamp}, has={parts or 'nothing'})"
