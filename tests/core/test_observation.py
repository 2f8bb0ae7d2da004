"""Observations decode late and say what is missing."""

import cv2
import numpy as np
import pytest

from placecue import EncodedImage, LaserScan, Observation, Pose2D, UnusableObservation


def scan_of(ranges: list[float]) -> LaserScan:
    return LaserScan(np.linspace(-1, 1, len(ranges)), np.array(ranges), 0.1, 10.0)


def test_an_image_is_decoded_once_on_first_use() -> None:
    calls = []

    def decode() -> np.ndarray:
        calls.append(1)
        return np.zeros((2, 2, 3), np.uint8)

    observation = Observation(0, image=decode)
    assert observation.has("image")
    assert not calls
    assert observation.image is observation.image
    assert len(calls) == 1
    assert not Observation(0).has("image")
    assert Observation(0).image is None


def test_encoded_images_come_back_as_rgb_or_grey() -> None:
    red = np.zeros((4, 5, 3), np.uint8)
    red[..., 0] = 255
    png = cv2.imencode(".png", cv2.cvtColor(red, cv2.COLOR_RGB2BGR))[1].tobytes()
    assert (EncodedImage(png, "png")() == red).all()
    grey = cv2.imencode(".png", red[..., 0])[1].tobytes()
    assert EncodedImage(grey, "png")().shape == (4, 5)


@pytest.mark.parametrize("data", [b"", b"\xff\xd8 no picture"])
def test_an_image_that_does_not_decode_is_unusable(data: bytes) -> None:
    with pytest.raises(UnusableObservation, match="does not decode"):
        EncodedImage(data, origin="image at stamp 7")()


def test_invalid_beams_become_the_maximum_range() -> None:
    scan = scan_of([np.nan, np.inf, 0.05, 3.0, 11.0])
    assert scan.filled().tolist() == [10.0, 10.0, 10.0, 3.0, 10.0]
    assert scan.points().shape == (1, 2)


@pytest.mark.parametrize("ranges", [[], [np.nan, np.nan], [0.0, np.inf]])
def test_a_scan_without_a_valid_beam_is_unusable(ranges: list[float]) -> None:
    with pytest.raises(UnusableObservation, match=r"0 beams|valid"):
        scan_of(ranges).filled()


def test_points_follow_the_mount() -> None:
    mount = Pose2D(1.0, 0.0, np.pi / 2)
    scan = LaserScan(np.array([0.0]), np.array([2.0]), 0.0, 10.0, mount)
    assert scan.points()[0] == pytest.approx([1.0, 2.0])


def test_poses_compose() -> None:
    pose = Pose2D(1.0, 2.0, np.pi / 2).compose(Pose2D(1.0, 0.0, 0.1))
    assert (pose.x, pose.y, pose.theta) == pytest.approx((1.0, 3.0, np.pi / 2 + 0.1))


def test_missing_parts_are_named() -> None:
    with pytest.raises(UnusableObservation, match="no image and no scan at stamp 5"):
        Observation(5).require(("image", "scan"))
