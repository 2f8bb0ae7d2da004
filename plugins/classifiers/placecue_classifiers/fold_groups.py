"""Folds that share features, and with them Gram matrices."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from placecue.features import FeatureBatch
from placecue.folds import Rows
from placecue.kernel import Gram
from placecue_classifiers.grid import Setting
from placecue_classifiers.prepared import Preparations, Prepared

#: The training rows of a fold, and those held out.
Split: TypeAlias = tuple[Rows, Rows]


@dataclass(frozen=True)
class FoldGroup:
    """Folds that share features.

    Folds of samples by a cue that learns nothing are all of one group. Where the cue learns, each
    fold is a group of its own.

    Parameters
    ----------
    prepare : callable
        Returns the preparations of all n samples, for these folds.
    splits : sequence of (training rows, held-out rows)
        The folds.
    """

    prepare: Callable[[], Preparations]
    splits: Sequence[Split]

    @classmethod
    def learned(
        cls,
        features: Callable[[Rows], FeatureBatch],
        prepared: Callable[[Setting, FeatureBatch, Rows | None], Prepared],
        split: Split,
    ) -> FoldGroup:
        """Return the group of one fold, all of which learns from its training rows.

        Parameters
        ----------
        features : callable
            Gives the features of all n samples by a cue that has learned from the given rows.
        prepared : callable
            Prepares features for the parameters of a grid, learning from the given rows.
        split : (training rows, held-out rows)
        """
        training, _ = split

        def prepare() -> Preparations:
            of_fold = features(training)
            return Preparations(lambda setting: prepared(setting, of_fold, training))

        return cls(prepare, [split])


def grams(
    groups: Sequence[FoldGroup], rounds: Sequence[tuple[Setting, Setting]]
) -> Iterator[tuple[int, Gram, Sequence[Split]]]:
    """Yield the number of each round with a group's Gram matrix and folds, group after group.

    Parameters
    ----------
    groups : sequence of FoldGroup
    rounds : sequence of (preparation, light)
        Parameters for which samples are prepared, and light ones of the kernel.
    """
    for group in groups:
        prepare = group.prepare()
        for number, (preparation, light) in enumerate(rounds):
            yield number, prepare(preparation).gram(light), group.splits


def folds(
    groups: Sequence[FoldGroup], preparation: Setting, light: Setting
) -> Iterator[tuple[Gram, Rows, Rows]]:
    """Yield each fold with the Gram matrix of its group for one round of :func:`grams`."""
    for _, gram, splits in grams(groups, [(preparation, light)]):
        for training, held_out in splits:
            yield gram, training, held_out
