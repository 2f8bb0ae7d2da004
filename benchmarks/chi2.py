"""Chi-squared kernel of sparse histograms against scikit-learn: ``python benchmarks/chi2.py``."""

import os
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")

from pathlib import Path
from time import perf_counter

import cv2
import numpy as np
from scipy import sparse
from sklearn.metrics.pairwise import chi2_kernel

from placecue import Observation
from placecue.features import stack
from placecue_cues.crfh import CRFH
from placecue_kernels.chi2 import Chi2

IMAGES = Path(__file__).parents[1] / "tests" / "data" / "crfh"
FRAMES = 950
BLOCK = 20
#: Heights of the crops, pixels.
CROPS = ((70, 165), (120, 240))


def views(count: int, seed: int, heights: tuple[int, int]) -> sparse.csr_array:
    """Histograms of random crops of the photographs, as if a robot had looked around.

    The smaller the crops (heights in pixels), the smoother, and the fewer bins are occupied.
    """
    rng = np.random.default_rng(seed)
    photographs = [cv2.imread(str(IMAGES / f"{name}.png")) for name in ("camera", "astronaut")]
    rows = []
    for _ in range(count):
        photograph = photographs[rng.integers(2)]
        height = int(rng.uniform(*heights))
        y, x = rng.integers(241 - height), rng.integers(321 - height * 4 // 3)
        crop = photograph[y : y + height, x : x + height * 4 // 3]
        image = cv2.resize(crop, (320, 240))
        rows.append(CRFH().extract(Observation(0, image=image)))
    return stack(rows)


def seconds(call: Callable[[], object], repeats: int = 1) -> float:
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return float(np.median(times))


def peer_seconds(a: sparse.csr_array, b: sparse.csr_array) -> float:
    """Time scikit-learn on a block, dense over the columns that the frames occupy."""
    columns = np.unique(np.concatenate([a.indices, b.indices]))
    dense = []
    for rows in (a[:BLOCK], b[:BLOCK]):
        places = np.searchsorted(columns, rows.indices)
        narrow = sparse.csr_array((rows.data, places, rows.indptr), shape=(BLOCK, len(columns)))
        dense.append(narrow.toarray())
    ours = Chi2(1.0).gram(a[:BLOCK], b[:BLOCK])
    print(f"largest difference {np.abs(chi2_kernel(*dense) - ours).max():.1e}")
    return seconds(lambda: chi2_kernel(*dense), 5) * (FRAMES / BLOCK) ** 2


def compare(heights: tuple[int, int]) -> None:
    a, b = views(FRAMES, 1, heights), views(FRAMES, 2, heights)
    median = int(np.median(np.diff(a.indptr)))
    print(f"1 thread, {FRAMES} frames against {FRAMES}, median {median} bins occupied")
    kernel = Chi2()
    kernel.shared(a[:2], b[:2])
    kernel.shared(a[:2])
    peer = peer_seconds(a, b)
    print(f"peer: scikit-learn chi2_kernel   {peer:8.2f} s (from a {BLOCK} x {BLOCK} block)")
    between = seconds(lambda: kernel.shared(a, b))
    print(f"placecue Chi2, two batches       {between:8.2f} s, {peer / between:.0f}x")
    within = seconds(lambda: kernel.shared(a), 3)
    print(f"placecue Chi2, one batch         {within:8.2f} s, {peer / within:.0f}x")
    query = a[:1]
    single = 1e3 * seconds(lambda: kernel.gram(query, b), 100)
    ratio = 1e3 * peer / FRAMES / single
    print(f"placecue Chi2, one frame against {FRAMES}: {single:.2f} ms, {ratio:.0f}x")


def main() -> None:
    cv2.setNumThreads(1)
    for heights in CROPS:
        compare(heights)


if __name__ == "__main__":
    main()
