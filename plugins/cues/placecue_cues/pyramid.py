"""Which descriptors lie in which cells of the image."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError


def check_pyramid(levels: Sequence[int], cue: str) -> None:
    """Raise UsageError, in the name of a cue, unless there are levels of one cell or more."""
    if not len(levels) or min(levels) < 1:
        raise UsageError(f"{cue} needs pyramid levels >= 1, such as [1] or [1, 2]: {list(levels)}")


def cells(places: NDArray[np.float32], levels: Sequence[int]) -> Iterator[NDArray[np.bool_]]:
    """Yield for each cell which descriptors lie in it, level by level and row by row.

    Parameters
    ----------
    places : ndarray of float32, shape (n, 2)
        Row and column as shares of the image, in [0, 1].
    levels : sequence of int
        A level of k has k x k cells.

    References
    ----------
    Lazebnik, Schmid and Ponce, Beyond bags of features: spatial pyramid matching, CVPR 2006.
    """
    for level in levels:
        inside = np.minimum((places * level).astype(np.int64), level - 1)
        number = inside[:, 0] * level + inside[:, 1]
        for cell in range(level * level):
            yield number == cell
