"""Dense RootSIFT equals a plain definition, and is much like OpenCV's at the same places."""

import cv2
import numpy as np
import pytest

from pictures import grey_photograph, observe
from placecue import UnusableObservation
from placecue_cues.dense_sift import DenseSift
from placecue_cues.local_descriptors import Patches


def grid(**parameters: object) -> DenseSift:
    chosen = {"longest_side": 320, "step": 8, "cells": (6,), "contrast": 0.0, **parameters}
    return DenseSift(**chosen)


def extract(image: np.ndarray, **parameters: object) -> Patches:
    return grid(**parameters).patches(observe(image))


def by_definition(image: np.ndarray, top: int, left: int, cell: int) -> np.ndarray:
    """The descriptor of one patch whose first cell has its middle at (top, left)."""
    smooth = cv2.GaussianBlur(image.astype(np.float64), (0, 0), cell / 6)
    smooth = np.pad(smooth, 1, mode="edge")
    histogram = np.zeros((4, 4, 8))
    for y in range(image.shape[0]):
        for x in range(image.shape[1]):
            dx = (smooth[y + 1, x + 2] - smooth[y + 1, x]) / 2
            dy = (smooth[y + 2, x + 1] - smooth[y, x + 1]) / 2
            turn = np.arctan2(dy, dx) % (2 * np.pi) / (2 * np.pi) * 8
            low, share = int(turn) % 8, turn % 1
            for i in range(4):
                for j in range(4):
                    near = max(0, 1 - abs(y - top - i * cell) / cell)
                    near *= max(0, 1 - abs(x - left - j * cell) / cell)
                    near *= np.exp(-((i - 1.5) ** 2 + (j - 1.5) ** 2) / (2 * 2.0**2))
                    histogram[i, j, low] += np.hypot(dx, dy) * near * (1 - share)
                    histogram[i, j, (low + 1) % 8] += np.hypot(dx, dy) * near * share
    vector = histogram.ravel() / np.linalg.norm(histogram)
    vector = np.minimum(vector, 0.2)
    return np.sqrt(vector / vector.sum())


def test_one_patch_by_definition() -> None:
    image = grey_photograph()[60:100, 120:160]
    found = extract(image)
    # Patches begin at 0, 8 and 16; the centre of one is 1.5 cells from the middle of its first.
    assert found.descriptors.shape == (9, 128)
    at = np.flatnonzero(np.all(np.isclose(found.places * 40, (3 + 9, 11 + 9)), axis=1))
    assert at.size == 1
    wanted = by_definition(image, 3, 11, 6)
    np.testing.assert_allclose(found.descriptors[at[0]], wanted, atol=1e-4)


def test_much_like_opencv() -> None:
    image = grey_photograph()
    found = extract(image, step=16)
    height, width = image.shape
    points = [
        cv2.KeyPoint(float(c * width), float(r * height), 6 / 1.5, 0) for r, c in found.places
    ]
    for point in points:
        point.octave = 1 << 8  # the first layer of the first octave
    _, theirs = cv2.SIFT_create().compute(image, points)
    # Theirs turn with y upwards.
    theirs = theirs.reshape(-1, 4, 4, 8)[..., (8 - np.arange(8)) % 8].reshape(-1, 128)
    theirs = np.sqrt(theirs / np.maximum(theirs.sum(axis=1, keepdims=True), 1))
    likeness = np.einsum("ij,ij->i", found.descriptors, theirs)
    assert np.median(likeness) > 0.9


def test_scales_places_and_reduction() -> None:
    image = cv2.resize(grey_photograph(), (640, 480))
    found = extract(image, cells=(4, 10))
    assert found.places.min() > 0
    assert found.places.max() < 1
    np.testing.assert_allclose(np.linalg.norm(found.descriptors, axis=1), 1, atol=1e-5)
    small = cv2.resize(image, (320, 240), interpolation=cv2.INTER_AREA)
    np.testing.assert_array_equal(extract(small, cells=(4, 10)).descriptors, found.descriptors)


def test_patches_without_contrast_are_left_out() -> None:
    image = np.full((80, 80), 128, np.uint8)
    assert len(extract(image).descriptors) == 0
    image[:, 40:] = 140
    every, strong = extract(image), extract(image, contrast=2.0)
    assert 0 < len(strong.descriptors) < len(every.descriptors)
    assert np.abs(every.places[:, 1] - 0.5).max() < 0.3


def test_small_images() -> None:
    assert len(extract(grey_photograph()[:24, :24]).descriptors) == 1
    with pytest.raises(UnusableObservation, match="30x23 pixels, dense_sift needs 24 each way"):
        extract(grey_photograph()[:23, :30])
    assert len(extract(grey_photograph()[:24, :24], cells=(6, 40)).descriptors) == 1
