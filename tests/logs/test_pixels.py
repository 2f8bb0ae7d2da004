"""What a log says of its pixels: format words, cameras of another size, scans upside down."""

from __future__ import annotations

import logging
import math
from base64 import b64encode
from typing import Any

import cv2
import numpy as np
import pytest

from placecue.depth import Intrinsics
from placecue.errors import UnusableObservation
from placecue.logs import open_log
from placecue.logs.adapters.base import stated
from placecue.logs.joining.camera_info import CameraInfo, camera_info
from placecue.logs.messages.images import RawImage, compressed

COLOUR = (200, 60, 20)


def png(pixels: np.ndarray) -> bytes:
    return cv2.imencode(".png", pixels)[1].tobytes()


def mosaic(first: str) -> np.ndarray:
    """Return a Bayer mosaic of one colour whose upper left square has the given letters."""
    made = np.zeros((16, 32), np.uint8)
    for place, letter in enumerate(first):
        made[place // 2 :: 2, place % 2 :: 2] = COLOUR["rgb".index(letter)]
    return made


RGB = np.full((16, 32, 3), COLOUR, np.uint8)
GREY = np.full((16, 32), 90, np.uint8)


@pytest.mark.parametrize(
    ("words", "pixels", "due"),
    [
        ("png", RGB[..., ::-1], COLOUR),
        ("rgb8; png compressed bgr8", RGB[..., ::-1], COLOUR),
        ("bgr8; png compressed bgr8", RGB[..., ::-1], COLOUR),
        ("rgb8; png compressed", RGB[..., ::-1], COLOUR),
        ("rgb8; png compressed rgb8", RGB, COLOUR),
        ("bgr8; PNG compressed RGB8", RGB, COLOUR),
        ("bayer_rggb8; png compressed ", mosaic("rggb"), COLOUR),
        ("bayer_bggr8; png compressed bayer_bggr8", mosaic("bggr"), COLOUR),
        ("bayer_gbrg8; png compressed ", mosaic("gbrg"), COLOUR),
        ("bayer_grbg8; png compressed ", mosaic("grbg"), COLOUR),
        ("bayer_rggb8; png compressed bgr8", RGB[..., ::-1], COLOUR),
        ("bayer_rggb8; png compressed mono8", GREY, 90),
        ("mono8; png compressed ", GREY, 90),
        ("rgb8; png compressed rgb8", GREY, 90),
    ],
)
def test_the_words_of_a_compressed_image(words: str, pixels: np.ndarray, due: Any) -> None:
    image = compressed(png(pixels), words, "it")()
    np.testing.assert_array_equal(image[5, 5], due)


def test_mono16_is_depth_in_millimetres() -> None:
    data = np.full((2, 3), 1500, "<u2").tobytes()
    np.testing.assert_allclose(RawImage(data, 2, 3, 6, "mono16").depth(), 1.5)


@pytest.mark.parametrize(("height", "width"), [(0, 4), (4, 0), (0, 0)])
def test_an_image_without_pixels_is_refused(height: int, width: int) -> None:
    with pytest.raises(UnusableObservation, match="bytes are not"):
        RawImage(bytes(64), height, width, 4, "mono8")()


def test_a_raw_image_larger_than_the_limit_is_refused() -> None:
    with pytest.raises(UnusableObservation, match=r"more than limits\.pixels="):
        RawImage(bytes(64), 10**6, 10**6, 0, "mono8")()


WHOLE = {"width": 640, "height": 480, "k": [500.0, 0, 319.5, 0, 500.0, 239.5, 0, 0, 1]}


@pytest.mark.parametrize(
    ("more", "size", "due"),
    [
        ({}, (640, 480), (500, 319.5, 239.5)),
        ({}, (320, 240), (250, 159.5, 119.5)),  # scaled: the middle stays the middle
        ({}, (1280, 960), (1000, 639.5, 479.5)),
        ({"width": 0, "height": 0}, (320, 240), (500, 319.5, 239.5)),
        ({"binning_x": 2, "binning_y": 2}, (320, 240), (250, 159.5, 119.5)),
        ({"binning_x": 2, "binning_y": 2}, (640, 480), (500, 319.5, 239.5)),
        (
            {"roi": {"x_offset": 100, "y_offset": 40, "width": 400, "height": 300}},
            (400, 300),
            (500, 219.5, 199.5),
        ),
    ],
)
def test_a_camera_of_another_size(more: Any, size: Any, due: Any) -> None:
    camera = camera_info({**WHOLE, **more})
    assert camera is not None
    found = camera.of_image(*size)
    assert (found.fx, found.cx, found.cy) == pytest.approx(due)
    assert isinstance(found, Intrinsics)


def test_a_camera_of_another_shape_is_refused() -> None:
    with pytest.raises(UnusableObservation, match="640 x 400 pixels, and its camera is described"):
        CameraInfo(640, 480, 500.0, 319.5, 239.5).of_image(640, 400)


@pytest.mark.parametrize("k", [None, [], [0.0] * 9, [math.nan] * 9, [1.0, 2.0]])
def test_a_camera_that_is_not_calibrated(k: Any) -> None:
    assert camera_info({"width": 4, "height": 4, "k": k}) is None


@pytest.mark.parametrize("none", [math.inf, -math.inf, math.nan, 3.4028234663852886e38, 0.0, -1.0])
def test_an_absurd_limit_of_range_is_none(none: float) -> None:
    assert math.isnan(stated(none))


def put_scan(log: Any, t: float, orientation: dict[str, float], **more: Any) -> None:
    pose = {"position": {"x": 0.3, "y": 0.2, "z": 0.5}, "orientation": orientation}
    ranges = [1.0, 2.0, 3.0]
    message = {
        **{"timestamp": log.time(t), "frame_id": "base_link", "pose": pose, "start_angle": -1.0},
        **{"end_angle": 1.0, "ranges": ranges, "intensities": [], "range_max": 9.0, **more},
    }
    log.put("/scan", "foxglove.LaserScan", message, t)


def test_a_scan_that_says_to_hang_upside_down(as_json: Any) -> None:
    """Turned about x by half a turn: what was on the left is on the right."""
    log = as_json()
    put_scan(log, 0.0, {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0})
    (observation,) = open_log(log.close())
    scan = observation.scan
    assert scan is not None
    assert scan.ranges.tolist() == [3.0, 2.0, 1.0]
    np.testing.assert_allclose(scan.angles, [-1.0, 0.0, 1.0])
    assert (scan.mount.x, scan.mount.y) == (0.3, 0.2)
    assert scan.mount.theta == pytest.approx(0.0)


def test_a_limit_that_changes_does_not_change_what_filled_beams_are(
    as_json: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = as_json()
    level = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    for number, limit in enumerate([8.0, 5.0, 12.0]):
        put_scan(log, number, level, ranges=[1.0, 7.0, "Infinity"], range_max=limit)
    with caplog.at_level(logging.WARNING):
        scans = [each.scan for each in open_log(log.close())]
    filled = [scan.filled().tolist() for scan in scans if scan is not None]
    # What a scanner of 5 m says beyond that is nothing.
    assert filled == [[1.0, 7.0, 8.0], [1.0, 8.0, 8.0], [1.0, 7.0, 8.0]]
    assert (
        sum("the first scan counts up to 8 m" in record.message for record in caplog.records) == 1
    )


def test_a_label_that_no_file_takes_ends_the_one_before_and_is_said_once(
    as_json: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = as_json()
    for t, label in ((0.0, "hall"), (0.15, "\ud800"), (0.35, "office")):
        stamp = log.time(t)
        number = stamp["sec"] * 10**9 + stamp["nsec"]
        log.put("/label", "placecue.Label", {"stamp": number, "label": label}, t)
    for number in range(5):
        put_scan(log, 0.1 * number, {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0})
    with caplog.at_level(logging.WARNING):
        labels = [each.label for each in open_log(log.close())]
    assert labels == ["hall", "hall", None, None, "office"]
    (record,) = [each for each in caplog.records if "half a character" in each.message]
    assert "1 messages could not be used" in record.message


def test_an_image_whose_data_are_no_text_is_counted(
    as_json: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = as_json()
    data = b64encode(png(RGB)).decode()
    for number, (form, content) in enumerate(
        [("png", data), (3, data), ("png", [1]), ("png", data)]
    ):
        t = 0.1 * number
        image = {"timestamp": log.time(t), "frame_id": "cam", "format": form, "data": content}
        log.put("/image", "foxglove.CompressedImage", image, t)
    with caplog.at_level(logging.WARNING):
        assert len(list(open_log(log.close()))) == 2
    assert "2 messages could not be used" in caplog.text


def test_a_scan_of_more_beams_than_the_limit_is_counted(
    as_json: Any, caplog: pytest.LogCaptureFixture
) -> None:
    log = as_json()
    level = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    put_scan(log, 0.0, level)
    put_scan(log, 0.1, level, ranges=[1.0] * 100_001)
    with caplog.at_level(logging.WARNING):
        assert len(list(open_log(log.close()))) == 1
    assert "a scan of 100001 beams, more than limits.beams=100000 allows" in caplog.text
