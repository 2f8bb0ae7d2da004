"""Images as they lie in a log, decoded on first use."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from placecue.decoding import decoded
from placecue.errors import UnusableObservation
from placecue.image_size import check_pixels
from placecue.observation import EncodedImage, Image


@dataclass(frozen=True, slots=True)
class PixelFormat:
    """How pixels lie in memory.

    Parameters
    ----------
    channels : int
        Numbers a pixel.
    order : tuple of 3 int, or None
        Which of them are red, green and blue; None where the only one is grey.
    depth : int
        Bits a number: 8 or 16. Of 16 the upper 8 are taken.
    code : str or None
        OpenCV's name of the conversion to RGB, for mosaics and YUV.
    """

    channels: int
    order: tuple[int, int, int] | None = None
    depth: int = 8
    code: str | None = None


RGB, BGR = (0, 1, 2), (2, 1, 0)
MOSAICS = ("rggb", "bggr", "gbrg", "grbg")
#: By the names of sensor_msgs/image_encodings, in lower case.
FORMATS: dict[str, PixelFormat] = {
    "mono8": PixelFormat(1),
    "8uc1": PixelFormat(1),
    "mono16": PixelFormat(1, depth=16),
    "rgb8": PixelFormat(3, RGB),
    "bgr8": PixelFormat(3, BGR),
    "8uc3": PixelFormat(3, BGR),
    "rgba8": PixelFormat(4, RGB),
    "bgra8": PixelFormat(4, BGR),
    "8uc4": PixelFormat(4, BGR),
    "rgb16": PixelFormat(3, RGB, 16),
    "bgr16": PixelFormat(3, BGR, 16),
    "rgba16": PixelFormat(4, RGB, 16),
    "bgra16": PixelFormat(4, BGR, 16),
    "uyvy": PixelFormat(2, code="COLOR_YUV2RGB_UYVY"),
    "yuv422": PixelFormat(2, code="COLOR_YUV2RGB_UYVY"),
    "yuyv": PixelFormat(2, code="COLOR_YUV2RGB_YUYV"),
    "yuv422_yuy2": PixelFormat(2, code="COLOR_YUV2RGB_YUYV"),
    **{
        f"bayer_{name}{depth}": PixelFormat(1, depth=depth, code=f"COLOR_Bayer{name.upper()}2RGB")
        for name in MOSAICS
        for depth in (8, 16)
    },
}
#: Codecs by the words that messages use for them.
CODECS = ("png", "webp", "avif")
#: Pixel formats of depth images, with the type of a pixel and the length of its unit, m.
DEPTH_FORMATS: dict[str, tuple[str, float]] = {"16uc1": ("u2", 1e-3), "32fc1": ("f4", 1.0)}


@dataclass(frozen=True, slots=True)
class RawImage:
    """Uncompressed pixels as they lie in a log, converted when called.

    Parameters
    ----------
    data : bytes
        The rows, each ``step`` bytes long.
    height, width : int
        Size, pixels.
    step : int
        Length of a row, bytes; 0 where rows are not padded.
    encoding : str
        Name of the pixel format, such as ``bgr8`` (see sensor_msgs/image_encodings).
    origin : str
        Where it comes from, for messages.
    big_endian : bool
        Byte order of numbers of 16 bits and more.
    """

    data: bytes
    height: int
    width: int
    step: int
    encoding: str
    origin: str = "image"
    big_endian: bool = False

    def __call__(self) -> Image:
        """Convert to RGB (H, W, 3), or to grey (H, W) where the pixels are grey.

        Raises
        ------
        UnusableObservation
            If the pixel format is not known or holds no picture, or there are too few bytes.
        """
        name = self.encoding.lower()
        if name in DEPTH_FORMATS:
            raise UnusableObservation(
                f"{self.origin}: '{self.encoding}' is a depth image and no picture; choose "
                "another topic with source.image_topic"
            )
        if name not in FORMATS:
            raise UnusableObservation(
                f"{self.origin}: pixel format '{self.encoding}' is not known; "
                f"known: {', '.join(sorted(FORMATS))}"
            )
        return self._converted(FORMATS[name])

    def depth(self) -> NDArray[np.float32]:
        """Return a depth image in m, shape (H, W); 0 and NaN are where nothing was measured.

        Raises
        ------
        UnusableObservation
            If the pixel format is not one of depth, or there are too few bytes.
        """
        name = self.encoding.lower()
        name = "16uc1" if name == "mono16" else name  # what some drivers call depth in mm
        if name not in DEPTH_FORMATS:
            raise UnusableObservation(
                f"{self.origin}: pixel format '{self.encoding}' is not depth; "
                f"depth are: {', '.join(sorted(DEPTH_FORMATS))}"
            )
        kind, unit = DEPTH_FORMATS[name]
        return (self._numbers(kind, 1)[:, :, 0] * np.float32(unit)).astype(np.float32)

    def _converted(self, format: PixelFormat) -> Image:
        pixels = self._numbers(f"u{format.depth // 8}", format.channels)
        if format.depth == 16:
            pixels = (pixels >> 8).astype(np.uint8)
        if format.code is not None:
            return self._by_opencv(np.ascontiguousarray(pixels), format.code)
        chosen = pixels[:, :, 0] if format.order is None else pixels[:, :, format.order]
        return np.ascontiguousarray(chosen, dtype=np.uint8)

    def _by_opencv(self, pixels: NDArray[np.uint8], code: str) -> Image:
        return _by_opencv(pixels, code, f"{self.origin}: pixels of {self.encoding}")

    def _numbers(self, kind: str, channels: int) -> NDArray[np.uint8]:
        """Return the pixels, shape (H, W, channels)."""
        type_ = np.dtype(f"{'>' if self.big_endian else '<'}{kind}")
        check_pixels(self.width, self.height, self.origin)
        width = self.width * channels * type_.itemsize
        step = self.step or width
        empty = self.height < 1 or self.width < 1 or not self.data
        if empty or step < width or len(self.data) < self.height * step:
            raise UnusableObservation(
                f"{self.origin}: {len(self.data)} bytes are not {self.width} x {self.height} "
                f"pixels of {self.encoding} in rows of {step}"
            )
        rows = np.frombuffer(self.data, np.uint8, self.height * step).reshape(self.height, step)
        pixels = np.ascontiguousarray(rows[:, :width]).view(type_)
        return pixels.reshape(self.height, self.width, channels)


@dataclass(frozen=True, slots=True)
class ReorderedImage:
    """An encoded image whose channels are not those of a picture file, decoded when called.

    Parameters
    ----------
    data : bytes
        The encoded image.
    code : str
        OpenCV's name of the conversion from what its decoder gives to RGB.
    channels : int
        How many channels it is for; an image of others is given as any decoder does.
    origin : str
        Where it comes from, for messages.
    """

    data: bytes
    code: str
    channels: int
    origin: str = "image"

    def __call__(self) -> Image:
        """Decode to RGB (H, W, 3), or to grey (H, W) where the image is grey.

        Raises
        ------
        UnusableObservation
            If it does not decode.
        """
        pixels = decoded(self.data, self.origin)
        if (1 if pixels.ndim == 2 else pixels.shape[2]) != self.channels:
            return EncodedImage(self.data, origin=self.origin)()
        if not self.code:
            return np.ascontiguousarray(pixels, dtype=np.uint8)
        return _by_opencv(pixels, self.code, f"{self.origin}: its pixels")


def compressed(data: bytes, words: str, origin: str) -> EncodedImage | ReorderedImage:
    """Return the image of a message of compressed pixels.

    ROS writes ``PIXELS; CODEC compressed ENCODED``: what the camera gave, and what was handed to
    the encoder (``image_transport_plugins``, compressed_publisher). Encoders take BGR; pixels that
    were handed over as RGB lie in the file the other way round, and a mosaic that was not
    converted is a grey picture.

    Parameters
    ----------
    data : bytes
        The encoded image.
    words : str
        The field ``format``, such as ``jpeg`` or ``rgb8; jpeg compressed bgr8``.
    origin : str
        Where it comes from, for messages.
    """
    code, channels, codec = _meant(words)
    if channels:
        return ReorderedImage(data, code, channels, origin)
    return EncodedImage(data, codec, origin)


@lru_cache(maxsize=64)
def _meant(words: str) -> tuple[str, int, str]:
    """Return what the words say: conversion and channels, 0 for any decoder's, and codec."""
    pixels, _, rest = words.lower().partition(";")
    encoded = rest.partition("compressed")[2].strip()
    mosaic = FORMATS.get(pixels.strip())
    codec = next((name for name in CODECS if name in words.lower()), "jpeg")
    if encoded.startswith("rgb"):
        return "", 3, codec
    if mosaic is not None and "bayer" in pixels and encoded in ("", pixels.strip()):
        assert mosaic.code is not None  # every mosaic has one
        return mosaic.code, 1, codec
    return "", 0, codec


def _by_opencv(pixels: NDArray[np.uint8], code: str, what: str) -> Image:
    import cv2

    try:
        return np.asarray(cv2.cvtColor(pixels, getattr(cv2, code)), dtype=np.uint8)
    except cv2.error as error:  # such as an odd width in YUV
        raise UnusableObservation(
            f"{what}, {pixels.shape[1]} x {pixels.shape[0]}, do not convert: "
            f"{' '.join(error.err.split())}"
        ) from error
