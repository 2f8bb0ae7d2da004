"""What adapters promise to return: checks for :func:`placecue.guard.call`."""

from __future__ import annotations

from typing import Any

from placecue import contracts
from placecue.errors import described
from placecue.guard import Check
from placecue.logs.adapters.base import Role
from placecue.logs.messages.geometry import Transform


def text(made: Any) -> str | None:
    """Check the name of a frame or of a pixel format, or a label; it may be empty."""
    return None if isinstance(made, str) else f"returned {described(made)}, not a text"


def _image(made: Any) -> str | None:
    return None if callable(made) else f"returned {described(made)}, not what decodes an image"


def _transforms(made: Any) -> str | None:
    if not isinstance(made, list):
        return f"returned {described(made)}, not a list of Transform"
    strange = next((each for each in made if not isinstance(each, Transform)), None)
    return None if strange is None else f"returned a list with {described(strange)} in it"


#: What ``value`` returns, by the role of the adapter.
VALUES: dict[Role, Check] = {
    "image": _image,
    "scan": contracts.scan,
    "pose": contracts.pose,
    "label": text,
    "transform": _transforms,
}
