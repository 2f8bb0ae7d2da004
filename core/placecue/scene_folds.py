"""Folds that part no scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.errors import DataError
from placecue.folds import FoldScheme


class Scenes(FoldScheme):
    """Whole scenes, dealt so that each fold holds a like share of every class.

    Frames of one scene (a visit of one room, a clip) are near-copies, and where scenes are short
    any cut by time or order parts some. Scenes are dealt from the largest to the smallest, each
    to the fold that holds least of its classes, then to the one that holds fewest samples, then
    to the first. Without scenes in a log the whole log is one: then these are folds by log,
    balanced over classes.

    A class of one scene cannot be held out and trained on: it stays in the training rows of every
    fold and is not scored. A class of fewer scenes than folds is scored in as many folds as it
    has scenes.

    Parameters
    ----------
    n_folds : int
        Number of folds.
    """

    def assign(
        self,
        labels: ArrayLike,
        stamps: ArrayLike | None = None,
        groups: ArrayLike | None = None,
    ) -> NDArray[np.int64]:
        """Return the fold of each sample, shape (n,); see :meth:`FoldScheme.assign`.

        Raises
        ------
        DataError
            If the scene of each sample is not known, or all are of one.
        """
        counts, scene = _counts(np.asarray(labels), groups)
        shares = counts / counts.sum(axis=0)
        fold_of = np.empty(len(counts), dtype=np.int64)
        held = np.zeros((self.n_folds, counts.shape[1]))
        sizes = np.zeros(self.n_folds)
        for number in np.argsort(-counts.sum(axis=1), kind="stable"):
            # Rounded, or the order of sums would decide between folds that hold the same.
            alike = np.round(held @ shares[number], 9)
            fold = np.lexsort((sizes, alike))[0]
            fold_of[number] = fold
            held[fold] += shares[number]
            sizes[fold] += counts[number].sum()
        return fold_of[scene]


def _counts(
    labels: NDArray[np.str_], groups: ArrayLike | None
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return how many samples of each class a scene has, scenes in order, and that of each."""
    known = np.zeros(len(labels), dtype=np.int64) if groups is None else np.asarray(groups)
    names, first, scene = np.unique(known, return_index=True, return_inverse=True)
    if len(names) < 2:
        raise DataError(
            f"folds scenes need two scenes or more, and the {len(labels)} samples are of one: "
            "give another log, or a source that tells scenes (a folder each for image_folder, "
            "scene_column or cuts for rgbd), or choose other folds, such as interleaved"
        )
    order = np.argsort(first)
    scene = np.argsort(order)[scene]  # numbered as they come
    classes, of_class = np.unique(labels, return_inverse=True)
    counts = np.zeros((len(names), len(classes)), dtype=np.int64)
    np.add.at(counts, (scene, of_class), 1)
    return counts, scene
