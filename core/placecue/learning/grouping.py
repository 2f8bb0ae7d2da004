"""What belongs together among samples: those of one log, and of one scene in it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.observation import Origin


def groups_of(
    origins: Sequence[Origin | None], scenes: Sequence[str | None]
) -> NDArray[np.int64] | None:
    """Return the log of each sample, and its scene where a source knows scenes, as numbers.

    Parameters
    ----------
    origins : sequence of n origins
        Where the samples come from; None where that is not known.
    scenes : sequence of n str or None
        Their scenes. Samples of a log without a scene count as one more scene of it.

    Returns
    -------
    ndarray of int64
        The log of each sample, shape (n,); where one has a scene the log and the scene, shape
        (n, 2). None where neither is known. Logs count as one where they are not known of all.
    """
    logs = [origin.log for origin in origins if origin is not None]
    known = len(logs) == len(origins)
    named = any(scene is not None for scene in scenes)
    if not known and not named:
        return None
    log = _numbers(logs) if known else np.zeros(len(origins), dtype=np.int64)
    if not named:
        return log
    pairs = [f"{number} {scene or ''}" for number, scene in zip(log, scenes, strict=True)]
    return np.column_stack([log, _numbers(pairs)])


def _numbers(names: Sequence[str]) -> NDArray[np.int64]:
    return np.unique(names, return_inverse=True)[1].astype(np.int64)
