"""One CRFH frame against the plain way: ``python benchmarks/crfh.py``."""

import os
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")

from pathlib import Path
from time import perf_counter

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue import Observation
from placecue_cues.crfh import CRFH

IMAGE = Path(__file__).parents[1] / "tests" / "data" / "crfh" / "astronaut.png"
MASKS = {
    "Lxx": np.array([[1.0, -2, 1]]),
    "Lxy": np.array([[0.25, 0, -0.25], [0, 0, 0], [-0.25, 0, 0.25]]),
    "Lyy": np.array([[1.0], [-2], [1]]),
}


def plain(image: NDArray[np.uint8]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The definition with OpenCV and NumPy, one smoothing for each descriptor."""
    grey = image.astype(np.float64).sum(axis=2) / 3
    keys = np.zeros((210, 290), dtype=np.int64)
    place = 1
    for t in (4, 64):
        for mask in MASKS.values():
            size = 2 * int(np.ceil(3 * np.sqrt(t))) + 1
            smooth = cv2.GaussianBlur(
                grey, (size, size), np.sqrt(t), borderType=cv2.BORDER_CONSTANT
            )
            response = t * cv2.filter2D(smooth, -1, mask)[15:-15, 15:-15]
            bins = np.floor((response + 128) * 28 / 256).clip(0, 27).astype(np.int64)
            keys += bins * place
            place *= 28
    occupied, counts = np.unique(keys, return_counts=True)
    return occupied, counts / keys.size


def milliseconds(call: Callable[[], object], repeats: int = 100) -> float:
    call()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return 1e3 * float(np.median(times))


def main() -> None:
    cv2.setNumThreads(1)
    image = cv2.cvtColor(cv2.imread(str(IMAGE)), cv2.COLOR_BGR2RGB)
    observation = Observation(0, image=image)
    row = CRFH().extract(observation)
    keys, values = plain(image)
    found = np.minimum(values[np.isin(keys, row.indices)], row.data[np.isin(row.indices, keys)])
    print(f"1 thread, {image.shape[1]}x{image.shape[0]}, intersection with peer {found.sum():.4f}")
    peer = milliseconds(lambda: plain(image))
    print(f"peer: OpenCV and NumPy, plainly   {peer:6.2f} ms a frame")
    for precision in ("double", "single"):
        cue = CRFH(precision=precision)
        ours = milliseconds(lambda cue=cue: cue.extract(observation))
        print(f"placecue CRFH, {precision} precision {ours:6.2f} ms a frame, {peer / ours:.1f}x")


if __name__ == "__main__":
    main()
