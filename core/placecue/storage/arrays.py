"""Arrays of every kind as plain numpy arrays under names, and back."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast
from zipfile import BadZipFile, ZipFile

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from placecue.atomic import replacing
from placecue.features import DescriptorSets

Parts = dict[str, NDArray[Any]]
#: What :func:`parts_of` takes apart, by the names it gives them.
KINDS = ("array", "csr", "descriptors")
#: Kinds of numpy data that are kept: numbers, truth values and text; no objects.
_PLAIN = "biufUSM"


def parts_of(value: Any) -> tuple[dict[str, Any], Parts] | None:
    """Take an array, sparse matrix or batch of descriptor sets apart.

    Returns
    -------
    tuple of dict and dict, or None
        What it is, as JSON, and its plain arrays by name; None if it is nothing of the kind.
    """
    if isinstance(value, DescriptorSets):
        return {"@": "descriptors"}, {"values": value.values, "offsets": value.offsets}
    if sparse.issparse(value):
        csr = sparse.csr_array(value)
        parts = {"data": csr.data, "indices": csr.indices, "indptr": csr.indptr}
        return {"@": "csr", "shape": list(csr.shape)}, parts
    if isinstance(value, np.ndarray) and value.dtype.kind in _PLAIN:
        return {"@": "array"}, {"value": value}
    return None


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> Path:
    """Write an .npz file, whole or not at all, without pickle."""
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, allow_pickle=False, **cast(Any, arrays))
    return path


def read_arrays(path: Path) -> Parts:
    """Return the arrays of an .npz file once all checksums are known to be right.

    NumPy alone does not look at the checksum of an array whose header says too little.

    Raises
    ------
    Exception
        Of many kinds, if the file is not there or damaged.
    """
    with ZipFile(path) as file:
        spoilt = file.testzip()
    if spoilt is not None:
        raise BadZipFile(f"{spoilt} in {path} is damaged")
    with np.load(path, allow_pickle=False) as arrays:
        return dict(arrays)


def from_parts(what: Mapping[str, Any], parts: Mapping[str, NDArray[Any]]) -> Any:
    """Return what :func:`parts_of` took apart.

    Raises
    ------
    KeyError
        If a part is missing, or it is nothing of the kind.
    """
    kind = what["@"]
    if kind == "array":
        return parts["value"]
    if kind == "csr":
        arrays = tuple(parts[part] for part in ("data", "indices", "indptr"))
        return sparse.csr_array(arrays, shape=tuple(what["shape"]))
    if kind == "descriptors":
        return DescriptorSets(parts["values"], parts["offsets"])
    raise KeyError(kind)
