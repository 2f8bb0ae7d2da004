"""Images as they lie in files."""

from __future__ import annotations

import re
from collections.abc import Callable

from placecue.errors import UnusableObservation
from placecue.observation import EncodedImage, Image

#: What image files are called, in small letters.
SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".ppm", ".tif", ".tiff", ".webp")
MAGIC = {b"\x89PNG\r\n\x1a\n": "png", b"\xff\xd8\xff": "jpeg"}


def encoded(data: bytes, origin: str) -> Callable[[], Image]:
    """Return an image that is decoded when it is used.

    Parameters
    ----------
    data : bytes
        What is in the file. PNG and JPEG, told by their first bytes, pass into logs untouched;
        other formats are decoded on the way.
    origin : str
        Where it comes from, for messages.

    Raises
    ------
    UnusableObservation
        If the file is empty.
    """
    if not data:
        raise UnusableObservation(f"{origin} is empty")
    for magic, name in MAGIC.items():
        if data.startswith(magic):
            return EncodedImage(data, name, origin)
    # A log can hold PNG and JPEG alone, so it is not handed on as an encoded image.
    return EncodedImage(data, "unknown format", origin).__call__


def is_image(name: str) -> bool:
    """Tell whether a file is called like an image."""
    return name.lower().endswith(SUFFIXES)


def natural(name: str) -> list[str | int]:
    """Return a key that sorts ``img2`` before ``img10``."""
    parts = re.split(r"([0-9]+)", name)
    return [int(part) if index % 2 else part for index, part in enumerate(parts)]
