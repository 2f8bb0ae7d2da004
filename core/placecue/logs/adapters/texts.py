"""Texts in messages that can be written nowhere."""

from __future__ import annotations

from typing import Any

from placecue.errors import UnusableObservation
from placecue.logs.messages.geometry import Transform
from placecue.observation import LaserScan, Pose2D


def check_writable(value: Any) -> None:
    r"""Refuse a part of an observation whose label or frame holds half a character.

    JSON can say one (``\ud800``), and no file or terminal takes it.

    Raises
    ------
    UnusableObservation
        If it does.
    """
    for text in _texts(value):
        if text.isascii():
            continue
        try:
            text.encode()
        except UnicodeEncodeError as error:
            shown = text.encode("ascii", "backslashreplace").decode()
            raise UnusableObservation(
                f"the text '{shown}' holds half a character, which can be written nowhere"
            ) from error


def _texts(value: Any) -> list[str]:
    if isinstance(value, str):
        return [value]
    if isinstance(value, Pose2D):
        return [value.frame]
    if isinstance(value, LaserScan):
        return [value.mount.frame]
    if isinstance(value, list):
        return [name for each in value if isinstance(each, Transform) for name in _names(each)]
    return []


def _names(transform: Transform) -> tuple[str, str]:
    return transform.parent, transform.child
