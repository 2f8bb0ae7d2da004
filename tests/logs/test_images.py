"""Pixel formats, with colours worked by hand."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from placecue.errors import UnusableObservation
from placecue.logs import open_log
from placecue.logs.messages.images import RawImage

RED, GREEN, BLUE = 200, 100, 50


def mosaic(order: str) -> np.ndarray:
    """Return what a sensor of such a mosaic sees of one colour all over, 6 x 8 pixels."""
    value = {"r": RED, "g": GREEN, "b": BLUE}
    tile = np.array([value[letter] for letter in order], np.uint8).reshape(2, 2)
    return np.tile(tile, (3, 4))


@pytest.mark.parametrize("order", ["rggb", "bggr", "gbrg", "grbg"])
@pytest.mark.parametrize("depth", [8, 16])
def test_mosaics(order: str, depth: int) -> None:
    pixels = mosaic(order).astype(np.uint16) << (depth - 8)
    data = pixels.astype(f"<u{depth // 8}").tobytes()
    image = RawImage(data, 6, 8, 0, f"bayer_{order}{depth}")()
    assert image.shape == (6, 8, 3)
    np.testing.assert_array_equal(image[2:-2, 2:-2], np.full((2, 4, 3), [RED, GREEN, BLUE]))


@pytest.mark.parametrize(
    ("encoding", "places"),
    [
        ("yuv422", "UYVY"),
        ("uyvy", "UYVY"),
        ("yuv422_yuy2", "YUYV"),
        ("yuyv", "YUYV"),
    ],
)
def test_yuv(encoding: str, places: str) -> None:
    """Against ITU-R BT.601, R = 1.164 (Y - 16) + 1.596 (V - 128) and so on."""
    y, u, v = 120, 100, 170
    data = bytes({"Y": y, "U": u, "V": v}[letter] for letter in places) * 4
    image = RawImage(data, 2, 4, 0, encoding)()
    bright = 1.164 * (y - 16)
    colour = [
        bright + 1.596 * (v - 128),
        bright - 0.813 * (v - 128) - 0.391 * (u - 128),
        bright + 2.018 * (u - 128),
    ]
    np.testing.assert_allclose(image, np.broadcast_to(colour, (2, 4, 3)), atol=1.5)


@pytest.mark.parametrize("big_endian", [False, True])
def test_sixteen_bits(big_endian: bool) -> None:
    order = ">" if big_endian else "<"
    grey = np.array([[0x1234, 0xFFFF], [0x00FF, 0x0100]], f"{order}u2")
    image = RawImage(grey.tobytes(), 2, 2, 0, "mono16", big_endian=big_endian)()
    np.testing.assert_array_equal(image, [[0x12, 0xFF], [0x00, 0x01]])
    colour = np.array([[[0x1000, 0x2000, 0x3000]]], f"{order}u2")
    image = RawImage(colour.tobytes(), 1, 1, 0, "bgr16", big_endian=big_endian)()
    assert image.tolist() == [[[0x30, 0x20, 0x10]]]


def test_depth_in_metres() -> None:
    millimetres = np.array([[0, 1500, 65535]], "<u2")
    depth = RawImage(millimetres.tobytes(), 1, 3, 0, "16UC1").depth()
    np.testing.assert_allclose(depth, [[0, 1.5, 65.535]], rtol=1e-6)
    metres = np.array([[np.nan, 2.5]], ">f4")
    depth = RawImage(metres.tobytes(), 1, 2, 0, "32FC1", big_endian=True).depth()
    np.testing.assert_array_equal(depth, [[np.nan, 2.5]])


@pytest.mark.parametrize("encoding", ["16UC1", "32FC1"])
def test_a_depth_topic_is_never_the_camera(ros2: Any, encoding: str) -> None:
    log = ros2()
    for i in range(3):
        log.raw(i * 0.1, encoding, 2, 2, 0, bytes(16))
        log.scan(i * 0.1, [1.0, 2.0])
    path = log.close()
    opened = open_log(path)
    assert opened.choices["image"].topics == ()
    assert [topic.name for topic in opened.choices["scan"].topics] == ["/scan"]
    assert len(list(opened)) == 3


def test_a_camera_beside_a_depth_camera_is_found(ros2: Any) -> None:
    _, picture = cv2.imencode(".png", np.full((4, 4, 3), (BLUE, GREEN, RED), np.uint8))
    log = ros2()
    log.raw(0.0, "16UC1", 2, 2, 0, bytes(8))
    log.image(0.0, picture.tobytes(), topic="/camera")
    log.scan(0.0, [1.0])
    (observation,) = open_log(log.close())
    assert observation.image is not None
    assert observation.image[0, 0].tolist() == [RED, GREEN, BLUE]


def test_depth_without_intrinsics_says_what_is_missing(ros2: Any) -> None:
    from placecue.errors import DataError

    log = ros2()
    log.raw(0.0, "32FC1", 2, 2, 0, bytes(16))
    with pytest.raises(DataError, match="the intrinsics of their camera"):
        list(open_log(log.close()))


def test_an_unknown_format_is_told_once_a_log(ros2: Any) -> None:
    log = ros2()
    for i in range(5):
        log.raw(i * 0.1, "nv21", 2, 2, 0, bytes(8))
    for observation in open_log(log.close()):
        with pytest.raises(UnusableObservation, match="pixel format 'nv21' is not known"):
            _ = observation.image


def test_yuv_of_odd_width_does_not_convert() -> None:
    with pytest.raises(UnusableObservation, match="do not convert"):
        RawImage(bytes(12), 2, 3, 0, "yuyv")()
