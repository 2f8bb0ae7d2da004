"""From the bytes of an encoded image to pixels; what the decoder only mutters about is heard."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UnusableObservation
from placecue.image_size import check_size, white_of

#: What libjpeg prints of pixels that are wrong. Bytes too many, which cameras on USB often send
#: before the end of an image, leave the pixels right.
_SPOILT = re.compile(r"premature end|bad Huffman|found marker .* instead of|Inconsistent progr")
_OF_JPEG = re.compile(r"(?:Corrupt JPEG data|Premature end of JPEG|Invalid SOS)[^\n]*\n?")
_hearing = Lock()


def decoded(data: bytes, origin: str, flags: int | None = None) -> NDArray[Any]:
    """Return an encoded image with its channels in the order of OpenCV: (H, W, 3) or (H, W).

    Parameters
    ----------
    data : bytes
        The image, as a file would hold it.
    origin : str
        Where it comes from, for messages.
    flags : int, optional
        OpenCV's; by default 8 bits, in colour or grey as the image is.

    Raises
    ------
    UnusableObservation
        If it is none, is damaged as far as the decoder can tell, or is larger than
        ``limits.pixels``.
    """
    import cv2

    check_size(data, origin)
    if not data:
        raise UnusableObservation(f"{origin} does not decode: it is empty")
    raw = np.frombuffer(data, dtype=np.uint8)
    try:
        if flags is None and (scaled := _scaled_to_bytes(data)) is not None:
            return scaled
        how = cv2.IMREAD_ANYCOLOR if flags is None else flags
        image, said = _heard(lambda: cv2.imdecode(raw, how), data)
    except cv2.error as error:
        raise UnusableObservation(f"{origin} does not decode: {error.err}") from error
    if image is None:
        raise UnusableObservation(f"{origin} does not decode ({len(data)} bytes)")
    if _SPOILT.search(said):
        raise UnusableObservation(f"{origin} is damaged: {' '.join(said.split())}")
    return np.asarray(image)


def _scaled_to_bytes(data: bytes) -> NDArray[np.uint8] | None:
    """Return the pixels of a portable any-map whose white is not that of its bytes; else None."""
    found = white_of(data)
    if found is None or found.white in (0, 255, 65535):
        return None
    shape = (found.height, found.width, 3)[: 3 if found.colours else 2]
    count = int(np.prod(shape))
    if found.plain:
        values = np.array(data[found.start :].split(maxsplit=count)[:count]).astype(np.float64)
    else:
        kind = "u1" if found.white < 256 else ">u2"
        whole = len(data) - found.start >= count * np.dtype(kind).itemsize
        values = np.frombuffer(data, kind, count if whole else 0, found.start).astype(np.float64)
    if values.size != count:
        return None  # too few pixels, which the decoder refuses
    pixels = np.clip(np.rint(values * (255.0 / found.white)), 0, 255).astype(np.uint8)
    pixels = pixels.reshape(shape)
    return np.ascontiguousarray(pixels[..., ::-1]) if found.colours else pixels


def _heard(decode: Callable[[], Any], data: bytes) -> tuple[Any, str]:
    """Return what a decoder gives and what libjpeg printed meanwhile, which has no other way."""
    if not data.startswith(b"\xff\xd8"):
        return decode(), ""
    with _hearing, _stderr_kept() as said:
        image = decode()
    return image, "".join(said)


@contextmanager
def _stderr_kept() -> Iterator[list[str]]:
    """Give what libjpeg prints; everything else goes where it should once more."""
    said: list[str] = []
    try:
        kept, file = os.dup(2), _ear()
    except OSError:  # nobody listens, or there is no room: nothing is heard
        yield said
        return
    try:
        os.dup2(file.fileno(), 2)
        yield said
    finally:
        os.dup2(kept, 2)
        if file.seek(0, os.SEEK_END):
            file.seek(0)
            text = file.read().decode("utf-8", "replace")
            said += _OF_JPEG.findall(text)
            file.seek(0)
            file.truncate()
            os.write(2, _OF_JPEG.sub("", text).encode())
        os.close(kept)


@cache
def _ear() -> IO[bytes]:
    """Return the file that takes what is printed; a new one for each image takes time."""
    return tempfile.TemporaryFile(buffering=0)
