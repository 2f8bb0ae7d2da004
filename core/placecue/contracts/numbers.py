"""Arrays of numbers: Gram blocks, scaled features, scores, folds."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.contracts.words import all_finite, array, counted, rows
from placecue.errors import described
from placecue.scores import Layout, Scores


def gram(made: Any, n: int, m: int) -> str | None:
    """Check a Gram block between n and m samples."""
    wrong = _floats(made, (n, m))
    if wrong is None and not all_finite(made):
        wrong = "returned NaN or infinite numbers: are the features very large?"
    return wrong


def scaled(made: Any, shape: tuple[int, ...]) -> str | None:
    """Check scaled features: floats of the same shape."""
    return _floats(made, shape)


def scores(
    made: Any,
    n: int,
    layout: Layout | None = None,
    *,
    classes: tuple[str, ...] | None = None,
    gaps: bool = False,
) -> str | None:
    """Check the scores of n samples.

    Parameters
    ----------
    made : object
        What came.
    n : int
        How many samples were asked for.
    layout : Layout, optional
        The one that they must have.
    classes : tuple of str, optional
        The ones that they must be of, in whatever layout.
    gaps : bool
        Whether there may be NaN.
    """
    if not isinstance(made, Scores):
        return f"returned {described(made)}, not Scores"
    of: Any = made.layout
    if not isinstance(of, Layout):
        return f"returned scores whose layout is {described(of)}"
    if layout is not None and made.layout is not layout and made.layout != layout:
        return f"returned scores of layout {_layout(made.layout)}, not of {_layout(layout)}"
    if classes is not None and made.layout.classes != classes:
        return f"returned scores of {', '.join(made.layout.classes)}, not of {', '.join(classes)}"
    if isinstance(made.values, np.ndarray) and made.values.ndim == 2:
        wrong = rows(made.values, n)
        if wrong:
            return wrong
    wrong = _floats(made.values, (n, len(made.layout.columns)), "scores that are ")
    if wrong is None and not all_finite(made.values):
        kept = np.isnan(made.values) if gaps else False
        if not np.all(np.isfinite(made.values) | kept):
            wrong = f"returned {'infinite' if gaps else 'NaN or infinite'} scores"
    return wrong


def trained(made: Any, labels: NDArray[Any]) -> str | None:
    """Check that a classifier says what its scores will be: of the classes that it was given.

    Parameters
    ----------
    made : object
        The classifier, after its ``train``.
    labels : ndarray, shape (n,)
        The classes of the samples.
    """
    layout = getattr(made, "layout_", None)
    if not isinstance(layout, Layout):
        return f"left {described(layout)} as layout_, not a Layout"
    classes = tuple(map(str, np.unique(labels)))
    if tuple(layout.classes) != classes:
        return (
            f"left a layout_ of the classes {', '.join(map(str, layout.classes))}, where the "
            f"samples are of {', '.join(classes)}"
        )
    names = getattr(made, "labels_", classes)
    if not isinstance(names, (np.ndarray, list, tuple)) or len(names) != len(classes):
        return f"left {described(names)} as labels_, not {counted(len(classes), 'label')}"
    return None


def _floats(made: Any, shape: tuple[int, ...], what: str = "") -> str | None:
    if not isinstance(made, np.ndarray) or made.dtype.kind != "f":
        return f"returned {what}{array(made)}, not an array of floats"
    if made.shape != shape:
        return f"returned {what}an array of shape {made.shape}, not {shape}"
    return None


def _layout(layout: Layout) -> str:
    return f"{getattr(layout, 'name', type(layout).__name__)} ({', '.join(layout.classes)})"
