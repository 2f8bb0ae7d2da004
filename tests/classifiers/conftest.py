"""Five classes of places as blobs."""

import numpy as np
import pytest
from sklearn.datasets import make_blobs

NAMES = np.array(["corridor", "kitchen", "lab", "office", "printer"])


def five_blobs(seed: int, scale: int = 1) -> tuple[np.ndarray, np.ndarray]:
    sizes = [scale * n for n in (60, 30, 20, 40, 25)]
    centers = np.random.default_rng(3).uniform(-10, 10, (5, 6))
    features, codes = make_blobs(sizes, centers=centers, cluster_std=5.0, random_state=seed)
    return features.astype(np.float32).astype(np.float64), NAMES[codes]


@pytest.fixture(scope="session")
def seen() -> tuple[np.ndarray, np.ndarray]:
    return five_blobs(0)


@pytest.fixture(scope="session")
def unseen() -> tuple[np.ndarray, np.ndarray]:
    return five_blobs(1, 4)
