"""Features in parts, as the one vector that the parts make when they are joined.

Squared distances, dot products and intersections of joined vectors are the sums of those of the
parts, so that nothing has to be joined: sparse parts stay sparse.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import reduce

import numpy as np

from placecue.errors import UsageError
from placecue.features import FeatureBatch, FeatureParts, kind_of
from placecue.kernel import Gram

from .columns import check_same_width


def sum_over_pieces(
    of_piece: Callable[[FeatureBatch, FeatureBatch | None, str], Gram],
    a: FeatureBatch,
    b: FeatureBatch | None = None,
) -> Gram:
    """Return the sum of what a function says of each part, shape (n, m).

    Parameters
    ----------
    of_piece : callable
        Given the same part of ``a`` and of ``b`` (None without one) and its name; of features in
        one piece, these and an empty name.
    a, b : batch of n and of m samples
        Both of the same kinds and widths.

    Raises
    ------
    UsageError
        If the two batches differ in their parts or columns.
    """
    return reduce(np.add, (of_piece(*piece) for piece in pieces(a, b)))


def pieces(
    a: FeatureBatch, b: FeatureBatch | None = None
) -> Iterator[tuple[FeatureBatch, FeatureBatch | None, str]]:
    """Yield the parts of two batches with their names; those in one piece have an empty name."""
    if not isinstance(a, FeatureParts):
        if b is not None:
            check_same_width(a, b)
        yield a, b, ""
        return
    check_same_parts(a, b)
    for name, part in a.parts.items():
        other = None if b is None else b.parts[name]  # type: ignore[union-attr]
        if other is not None:
            check_same_width(part, other)
        yield part, other, name


def check_same_parts(a: FeatureParts, b: FeatureBatch | None) -> None:
    """Raise UsageError unless the samples of both batches have the same parts."""
    if b is None or (isinstance(b, FeatureParts) and a.parts.keys() == b.parts.keys()):
        return
    other = ", ".join(b.parts) if isinstance(b, FeatureParts) else f"a {kind_of(b)} in one piece"
    raise UsageError(
        f"a kernel between samples of the parts {', '.join(a.parts)} and of {other}: both batches "
        "must come from the same cue with the same parts"
    )
