"""SIFT gives OpenCV's descriptors, the strongest ones, in one order."""

import cv2
import numpy as np
import pytest

from pictures import grey_photograph, observe, photograph
from placecue_cues.sift import SIFT


def of_opencv(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All of OpenCV's descriptors and their responses."""
    points, descriptors = cv2.SIFT_create().detectAndCompute(image, None)
    return descriptors, np.array([point.response for point in points])


def test_descriptors_are_the_strongest_of_opencv() -> None:
    image = grey_photograph()
    descriptors, responses = of_opencv(image)
    found = SIFT(keypoints=50, root=False).features(observe(image))
    assert found.shape == (50, 128)
    assert found.dtype == np.float32
    weakest = np.sort(responses)[-50]
    strong = {tuple(row) for row in descriptors[responses >= weakest]}
    assert all(tuple(row) in strong for row in found)


def test_order_is_that_of_response() -> None:
    image = grey_photograph()
    descriptors, responses = of_opencv(image)
    response = {tuple(row): each for row, each in zip(descriptors, responses, strict=True)}
    found = SIFT(keypoints=400, root=False).features(observe(image))
    order = [response[tuple(row)] for row in found]
    assert order == sorted(order, reverse=True)
    np.testing.assert_array_equal(
        found[:30], SIFT(keypoints=30, root=False).features(observe(image))
    )


def test_root_sift() -> None:
    image = photograph()
    plain = SIFT(root=False).features(observe(image)).astype(np.float64)
    rooted = SIFT().features(observe(image))
    np.testing.assert_allclose(rooted, np.sqrt(plain / plain.sum(axis=1, keepdims=True)), atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(rooted, axis=1), 1, atol=1e-6)


@pytest.mark.parametrize("shape", [(120, 160), (1, 1), (3, 200)])
def test_images_without_interest_points_give_an_empty_set(shape: tuple[int, int]) -> None:
    found = SIFT().features(observe(np.full(shape, 90, np.uint8)))
    assert found.shape == (0, 128)
    assert found.dtype == np.float32


def test_empty_and_full_sets_make_a_batch() -> None:
    batch = SIFT(keypoints=20).transform(
        [observe(np.zeros((60, 60), np.uint8)), observe(photograph())]
    )
    np.testing.assert_array_equal(batch.offsets, [0, 0, 20])
