"""Sizes in the headers of images, and images that are refused for theirs."""

from __future__ import annotations

import struct

import cv2
import numpy as np
import pytest

from placecue.errors import UnusableObservation
from placecue.image_size import size_of
from placecue.limits import limited
from placecue.observation import EncodedImage


def encoded(suffix: str, shape: tuple[int, ...] = (7, 11, 3), *options: int) -> bytes:
    made, data = cv2.imencode(suffix, np.full(shape, 90, np.uint8), options)
    assert made
    return data.tobytes()


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".pgm", ".ppm", ".bmp", ".tiff", ".webp"])
def test_the_header_says_the_size(suffix: str) -> None:
    shape = (7, 11) if suffix == ".pgm" else (7, 11, 3)
    assert size_of(encoded(suffix, shape)) == (11, 7)


def test_progressive_and_lossless_ones_too() -> None:
    assert size_of(encoded(".jpg", (7, 11, 3), cv2.IMWRITE_JPEG_PROGRESSIVE, 1)) == (11, 7)
    assert size_of(encoded(".webp", (7, 11, 3), cv2.IMWRITE_WEBP_QUALITY, 101)) == (11, 7)


def test_a_comment_in_a_pgm() -> None:
    assert size_of(b"P5 # made\n# by hand\n 3 # wide\n2 255\n" + bytes(6)) == (3, 2)


@pytest.mark.parametrize("length", range(40))
@pytest.mark.parametrize("suffix", [".png", ".jpg", ".bmp", ".tiff", ".webp"])
def test_a_header_that_ends_early_says_nothing_wrong(suffix: str, length: int) -> None:
    assert size_of(encoded(suffix)[:length]) in (None, (11, 7))


def test_what_is_no_image_has_no_size() -> None:
    assert size_of(b"") is None
    assert size_of(b"PK\3\4") is None


def huge_jpeg(side: int) -> bytes:
    data = encoded(".jpg")
    at = data.index(b"\xff\xc0")
    return data[: at + 5] + struct.pack(">HH", side, side) + data[at + 9 :]


def test_an_image_larger_than_the_limit_is_refused_before_it_is_decoded() -> None:
    with pytest.raises(UnusableObservation, match=r"32000 x 32000 pixels, more than limits\.p"):
        EncodedImage(huge_jpeg(32000), origin="/image")()


def test_the_limit_can_be_set() -> None:
    image = EncodedImage(encoded(".png"))
    with limited({"pixels": 77}):
        assert image().shape == (7, 11, 3)
    with limited({"pixels": 76}), pytest.raises(UnusableObservation, match=r"limits\.pixels=76"):
        image()


@pytest.mark.parametrize(
    ("white", "kind"), [(100, "u1"), (255, "u1"), (1023, ">u2"), (4095, ">u2"), (65535, ">u2")]
)
def test_white_of_a_pgm_is_what_it_says(white: int, kind: str) -> None:
    pixels = np.array([[0, white // 2, white]], kind)
    image = EncodedImage(f"P5\n3 1\n{white}\n".encode() + pixels.tobytes())()
    assert image[0].tolist() == pytest.approx([0, 127.5, 255], abs=1.0)


def test_white_of_a_ppm_and_of_one_in_text() -> None:
    pixels = np.array([[[1023, 0, 511]]], ">u2")
    image = EncodedImage(b"P6 1 1 1023\n" + pixels.tobytes())()
    assert image[0, 0].tolist() == [255, 0, 127]
    assert EncodedImage(b"P2\n3 1\n100\n0 40 100\n")()[0].tolist() == [0, 102, 255]


def test_a_jpeg_whose_decoder_complains_is_damaged(capfd: pytest.CaptureFixture[str]) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (96, 128, 3)).astype(np.uint8)
    data = bytearray(cv2.imencode(".jpg", noise)[1].tobytes())
    data[len(data) // 2 : len(data) // 2 + 40] = b"\xff\x99" * 20
    with pytest.raises(UnusableObservation, match="/image is damaged: Corrupt JPEG data"):
        EncodedImage(bytes(data), origin="/image")()
    assert capfd.readouterr().err == ""


def test_bytes_too_many_before_the_end_of_a_jpeg_do_no_harm(
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Cameras on USB pad their images."""
    data = encoded(".jpg", (16, 16, 3))
    padded = data[:-2] + bytes(7) + data[-2:]
    np.testing.assert_array_equal(EncodedImage(padded)(), EncodedImage(data)())
    assert capfd.readouterr().err == ""
