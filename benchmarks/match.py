"""Match kernel of local descriptors against OpenCV's matcher: ``python benchmarks/match.py``.

With ``--gram`` the whole Gram matrix instead, on every core.
"""

import os
import sys
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from time import perf_counter

import cv2
import numpy as np

from placecue import DescriptorSets
from placecue_kernels.match import Match

IMAGES, DESCRIPTORS, LENGTH = 950, 150, 128
BLOCK = 50


def images(count: int, seed: int) -> DescriptorSets:
    """Random RootSIFT descriptors; matching takes the same time whatever they are."""
    rng = np.random.default_rng(seed)
    shares = rng.gamma(0.6, size=(count * DESCRIPTORS, LENGTH)).astype(np.float32)
    values = np.sqrt(shares / shares.sum(axis=1, keepdims=True))
    return DescriptorSets(values, np.arange(0, len(values) + 1, DESCRIPTORS))


def by_opencv(one: DescriptorSets, many: DescriptorSets, gamma: float) -> np.ndarray:
    """The kernel with a brute-force matcher, image by image, both ways."""
    matcher = cv2.BFMatcher(cv2.NORM_L2)
    row = []
    for i in range(len(many)):
        other = many.values[many.offsets[i] : many.offsets[i + 1]]
        means = []
        for query, train in ((one.values, other), (other, one.values)):
            distances = np.array([match.distance for match in matcher.match(query, train)])
            means.append(np.exp(-gamma * distances**2).mean())
        row.append(sum(means) / 2)
    return np.array(row)


def seconds(call: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return min(times)


def one_image() -> None:
    cv2.setNumThreads(1)
    query, training, kernel = images(1, 0), images(IMAGES, 1), Match()
    kernel.gram(query, training)
    few = training[np.arange(BLOCK)]
    difference = np.abs(by_opencv(query, few, 1.0) - kernel.gram(query, few)[0]).max()
    print(f"1 thread, {DESCRIPTORS} descriptors against {IMAGES} images of as many")
    print(f"largest difference {difference:.1e}")
    peer = seconds(lambda: by_opencv(query, few, 1.0), 5) * IMAGES / BLOCK
    print(f"peer: loop over cv2.BFMatcher      {1e3 * peer:8.0f} ms (from {BLOCK} images)")
    ours = seconds(lambda: kernel.gram(query, training), 15)
    print(f"placecue Match                     {1e3 * ours:8.1f} ms, {peer / ours:.0f}x")
    products = seconds(lambda: query.values @ training.values.T, 15)
    work = 2 * DESCRIPTORS * len(training.values) * LENGTH / 1e9
    print(f"the multiplications alone, by BLAS {1e3 * products:8.1f} ms, {work:.1f} GFLOP")


def whole_gram() -> None:
    training = images(IMAGES, 1)
    cores = os.cpu_count() or 1
    kernel = Match(n_jobs=cores)
    kernel.gram(training[np.arange(4)])
    kept = None

    def match() -> None:
        nonlocal kept
        kept = kernel.shared(training)

    print(f"{cores} cores, {IMAGES} x {IMAGES} images of {DESCRIPTORS} descriptors")
    print(f"placecue Match, matching once      {seconds(match, 1):8.1f} s")
    each = seconds(lambda: kernel.from_shared(kept), 3)
    print(f"placecue Match, then each gamma    {each:8.2f} s")
    cv2.setNumThreads(1)
    peer = seconds(lambda: by_opencv(training[[0]], training[np.arange(BLOCK)], 1.0), 5)
    whole = peer / BLOCK * IMAGES * (IMAGES - 1) / 2
    print(f"peer: loop over cv2.BFMatcher      {whole:8.0f} s on one core (extrapolated)")


if __name__ == "__main__":
    if "--gram" in sys.argv:
        whole_gram()
    else:
        one_image()
