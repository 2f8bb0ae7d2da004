"""Features of observations, one or many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy import sparse

from placecue.contracts.words import all_finite, counted, numbers, rows, shown
from placecue.errors import described
from placecue.features import DescriptorSets, FeatureBatch, FeatureParts, form, kind_of


def features(made: Any) -> str | None:
    """Check the features of one observation: a vector, a CSR row or local descriptors, of numbers.

    Parts are a batch of one sample. Whether they are finite is :func:`finite`.
    """
    if isinstance(made, FeatureParts):
        return batch(made, 1)
    if sparse.issparse(made):
        return _csr(made, 1)
    if not isinstance(made, np.ndarray):
        return f"returned {described(made)}, not a vector, a CSR row or descriptors"
    if made.ndim not in (1, 2) or made.shape[-1] == 0:
        return f"returned an array of shape {made.shape}, not a vector (d,) or descriptors (k, d)"
    return numbers(made)


def batch(made: Any, n: int, like: FeatureBatch | None = None) -> str | None:
    """Check the features of n observations, and that they are as those seen in training.

    Parameters
    ----------
    made : object
        What came.
    n : int
        How many samples were asked for.
    like : batch, optional
        Features that these must fit: of the same kind, width and parts.
    """
    if isinstance(made, FeatureParts):
        wrong = _parts(made, n)
    elif isinstance(made, DescriptorSets):
        wrong = _descriptors(made)
    elif sparse.issparse(made):
        wrong = _csr(made, n)
    elif isinstance(made, np.ndarray):
        wrong = numbers(made) if made.ndim == 2 else f"returned an array of shape {made.shape}"
    else:
        wrong = f"returned {described(made)}, not a batch of features"
    return wrong or rows(made, n) or (None if like is None else _unlike(made, like))


def families(made: Any, like: FeatureBatch) -> str | None:
    """Check the families of features: None, or a name for each column of a batch, or by part."""
    if made is None:
        return None
    if isinstance(made, Mapping) and isinstance(like, FeatureParts):
        if not made.keys() <= like.parts.keys():
            return f"names the parts {', '.join(map(str, made))} of {', '.join(like.parts)}"
        return next(filter(None, (families(made[n], like.parts[n]) for n in made)), None)
    several = isinstance(made, Sequence) and not isinstance(made, str)
    if not several or not all(isinstance(name, str) for name in made):
        return f"is {shown(made)}, not a sequence of names or None"
    columns = like.shape[1]
    return None if len(made) == columns else f"names {counted(len(made), 'column')} of {columns}"


def finite(made: Any) -> str | None:
    """Check that numbers (features of any kind, or an array) are finite."""
    if isinstance(made, FeatureParts):
        return next(filter(None, map(finite, made.parts.values())), None)
    if isinstance(made, DescriptorSets):
        made = made.values
    values = made.data if sparse.issparse(made) else made
    return None if all_finite(values) else "returned NaN or infinite numbers"


def _csr(made: Any, n: int) -> str | None:
    if made.format != "csr" or made.ndim != 2 or made.shape[1] == 0:
        return f"returned {described(made)} of shape {made.shape}, not a CSR array of ({n}, bins)"
    # Loops over bins trust the indices, compiled ones blindly.
    if made.nnz and not (made.indices.min() >= 0 and made.indices.max() < made.shape[1]):
        return f"returned a CSR array of {made.shape[1]} bins with indices of others"
    return rows(made, n) or numbers(made.data)


def _descriptors(made: DescriptorSets) -> str | None:
    values, offsets = made.values, made.offsets
    if not isinstance(values, np.ndarray) or values.ndim != 2 or values.shape[1] == 0:
        return "returned descriptor sets whose values are no array (total, d)"
    steps = np.diff(offsets) if isinstance(offsets, np.ndarray) and offsets.ndim == 1 else ()
    whole = len(steps) and offsets.dtype.kind == "i" and offsets[0] == 0
    if not whole or offsets[-1] != len(values) or np.min(steps) < 0:
        return f"returned descriptor sets whose offsets do not part {len(values)} descriptors"
    return numbers(values)


def _parts(made: FeatureParts, n: int) -> str | None:
    if not isinstance(made.parts, Mapping) or not made.parts:
        return "returned features in parts without a part"
    for name, part in made.parts.items():
        nested = isinstance(part, FeatureParts)
        wrong = "returned parts of its own" if nested else batch(part, n)
        if wrong or not isinstance(name, str):
            return f"{wrong or 'returned a part whose name is no text'}, in part {name!r:.80}"
    return None


def _unlike(made: FeatureBatch, like: FeatureBatch) -> str | None:
    if isinstance(made, FeatureParts) or isinstance(like, FeatureParts):
        given, known = form(made), form(like)
        return None if given == known else f"returned {given} where training had {known}"
    if kind_of(made) is not kind_of(like):
        return f"returned a {kind_of(made)} where training had a {kind_of(like)}"
    if made.shape[1] != like.shape[1]:
        return f"returned features of width {made.shape[1]} where training had {like.shape[1]}"
    return None
