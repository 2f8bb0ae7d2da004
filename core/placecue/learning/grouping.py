"""What belongs together among samples: those of one log, and of one scene in it."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue.folds import FoldScheme, cut
from placecue.observation import Origin

log = logging.getLogger(__name__)


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
    numbers = _numbers(logs) if known else np.zeros(len(origins), dtype=np.int64)
    if not named:
        return numbers
    pairs = [f"{number} {scene or ''}" for number, scene in zip(numbers, scenes, strict=True)]
    return np.column_stack([numbers, _numbers(pairs)])


def say_parted(
    folds: FoldScheme,
    labels: NDArray[np.str_],
    stamps: NDArray[np.int64],
    groups: NDArray[np.int64] | None,
) -> None:
    """Warn if folds hold out a part of a scene: what they say of the rest flatters.

    Parameters
    ----------
    folds : FoldScheme
    labels, stamps, groups
        Of n samples; nothing is said where no scenes are known.
    """
    if groups is None or groups.ndim < 2:
        return
    scenes = groups[:, 1]
    try:
        splits = cut(folds, labels, stamps, groups)
    except DataError:
        return  # said by whoever cuts
    parted = {name for rows, held in splits for name in np.intersect1d(scenes[rows], scenes[held])}
    if parted:
        log.warning(
            f"folds {type(folds).__name__} part {len(parted)} of {len(np.unique(scenes))} scenes, "
            "whose observations are near-copies, so that what is searched and judged in them "
            "flatters: folds=scenes keeps scenes whole"
        )


def _numbers(names: Sequence[str]) -> NDArray[np.int64]:
    return np.unique(names, return_inverse=True)[1].astype(np.int64)
