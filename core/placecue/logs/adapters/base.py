"""What every adapter can do, and what several of them need."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import UnusableObservation
from placecue.limits import current_limits
from placecue.logs.messages.geometry import Transform

#: No scanner reaches so far, m: drivers that know no limit state infinity or the largest float.
BEYOND = 1e6

#: No sweep goes round more often.
MOST_TURNS = 2

Role = Literal["image", "scan", "pose", "label", "transform"]


class Adapter(ABC):
    """Takes a part of an observation out of decoded messages of one schema.

    Attributes
    ----------
    encodings : tuple of {"cdr", "ros1", "json", "protobuf"}
        The message encodings of the channels that it reads.
    schemas : tuple of str
        The names of their schemas; those of ROS 2 without ``/msg``.
    role : {"image", "scan", "pose", "label", "transform"}
        What :meth:`value` gives: a callable that decodes an image, a LaserScan, a Pose2D, a str
        (empty: no label), a list of Transform.
    header_first : bool
        Whether messages begin with a ROS header, so that the stamp can be read undecoded.
    """

    encodings: ClassVar[tuple[str, ...]]
    schemas: ClassVar[tuple[str, ...]]
    role: ClassVar[Role]
    header_first: ClassVar[bool] = False

    @abstractmethod
    def stamp(self, message: Any) -> int:
        """Return the time of measurement, ns; 0 where the message does not say."""

    @abstractmethod
    def value(self, message: Any, origin: str) -> Any:
        """Return the part.

        Parameters
        ----------
        message : object
            The decoded message.
        origin : str
            Where it comes from, for messages.

        Raises
        ------
        UnusableObservation
            If the message makes no sense.
        """

    def frame(self, message: Any) -> str:
        """Return the frame that the message is given in; empty where it does not say."""
        return ""

    def moved(self, message: Any) -> Transform | None:
        """Return where a pose puts which frame, in three dimensions; None where it does not say."""
        return None

    def is_turned(self, message: Any) -> bool:
        """Tell whether a pose says its heading: a quaternion of zeros does not."""
        return True

    def pixels(self, message: Any) -> str:
        """Return the pixel format of an image; empty where it does not say."""
        return ""


def increasing(
    first: float, step: float, ranges: ArrayLike, origin: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return angles and ranges of a sweep in order of increasing angle, each of shape (n,).

    Parameters
    ----------
    first, step : float
        Angle of the first beam and from one to the next, rad; the step may be negative.
    ranges : array_like, shape (n,)
        Lengths, m.
    origin : str
        Where it comes from, for messages.
    """
    count = np.shape(ranges)[0]
    over = current_limits().over("beams", count)
    if over:
        raise UnusableObservation(f"{origin} is a scan of {count} beams, {over}")
    lengths = np.asarray(ranges, dtype=np.float64)
    if len(lengths) > 1 and not (np.isfinite(first) and np.isfinite(step) and step != 0.0):
        raise UnusableObservation(
            f"{origin}: {len(lengths)} beams from {first} rad in steps of {step} rad"
        )
    turns = abs(step) * (count - 1) / (2 * np.pi)
    if count > 1 and turns > MOST_TURNS:
        raise UnusableObservation(
            f"{origin}: {count} beams in steps of {step:g} rad turn {turns:.0f} times"
        )
    angles = first + step * np.arange(len(lengths), dtype=np.float64)
    return (angles, lengths) if step >= 0 else (angles[::-1].copy(), lengths[::-1].copy())


def stated(range_max: float) -> float:
    """Return the limit that a scan states, m; NaN where it states none that a scanner can have."""
    return range_max if 0.0 < range_max < BEYOND else float("nan")
