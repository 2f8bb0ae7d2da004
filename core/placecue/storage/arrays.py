"""Arrays of every kind as plain numpy arrays under names, and back."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from io import BufferedReader, BytesIO
from pathlib import Path
from typing import IO, Any, cast
from zipfile import ZIP_STORED, ZipFile, ZipInfo

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray
from scipy import sparse

from placecue.atomic import replacing
from placecue.errors import DataError
from placecue.features import DescriptorSets, FeatureParts
from placecue.storage.guarded import opened, size_of

Parts = dict[str, NDArray[Any]]
#: What :func:`parts_of` takes apart, by the names it gives them.
KINDS = ("array", "csr", "descriptors", "parts")
#: Kinds of numpy data that are kept: numbers, truth values and text; no objects.
_PLAIN = "biufUSM"
#: Bytes that the header of an array of format 1.0 fits into.
_HEADER = 2**16 + 10
#: Bytes that are read at a time.
_BLOCK = 2**20


def parts_of(value: Any) -> tuple[dict[str, Any], Parts] | None:
    """Take an array, sparse matrix, or batch of descriptor sets or of features in parts, apart.

    Returns
    -------
    tuple of dict and dict, or None
        What it is, as JSON, and its plain arrays by name; None if it is nothing of the kind.
    """
    if isinstance(value, FeatureParts):
        return _parts_of_parts(value)
    if isinstance(value, DescriptorSets):
        return {"@": "descriptors"}, {"values": value.values, "offsets": value.offsets}
    if sparse.issparse(value):
        csr = sparse.csr_array(value)
        parts = {"data": csr.data, "indices": csr.indices, "indptr": csr.indptr}
        return {"@": "csr", "shape": list(csr.shape)}, parts
    if isinstance(value, np.ndarray) and value.dtype.kind in _PLAIN:
        return {"@": "array"}, {"value": value}
    return None


def _parts_of_parts(value: FeatureParts) -> tuple[dict[str, Any], Parts] | None:
    """Take features in parts apart; the arrays of part i are called ``i.NAME``."""
    apart = [parts_of(part) for part in value.parts.values()]
    whole = [each for each in apart if each is not None]
    if len(whole) < len(apart):
        return None
    arrays = {f"{i}.{n}": a for i, (_, parts) in enumerate(whole) for n, a in parts.items()}
    return {"@": "parts", "names": list(value.parts), "of": [what for what, _ in whole]}, arrays


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> Path:
    """Write an .npz file, whole or not at all, without pickle."""
    with replacing(path) as temporary:
        save_arrays(temporary, arrays)
    return path


def save_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write an .npz file without pickle and without compression."""
    with path.open("wb") as file:
        # NumPy before 2.2 would take allow_pickle=False for an array of that name.
        spoilt = [name for name, array in arrays.items() if array.dtype.hasobject]
        if spoilt:
            raise ValueError(f"array {spoilt[0]} holds objects, which only pickle could write")
        np.savez(file, **cast(Any, arrays))


def read_arrays(path: Path, names: Collection[str] | None = None) -> Parts:
    """Return the arrays of an .npz file that :func:`write_arrays` wrote.

    Nothing is unpacked or set aside that the file does not hold byte for byte, and every checksum
    is compared.

    Parameters
    ----------
    path : Path
        The file.
    names : collection of str, optional
        Which arrays; all by default.

    Raises
    ------
    DataError
        If it is no such file, is damaged, or holds anything but plain arrays.
    """
    with opened(path) as file:
        return arrays_in(file, path, names)


def arrays_in(file: BufferedReader, path: Path, names: Collection[str] | None = None) -> Parts:
    """Return the arrays of an open .npz file; see :func:`read_arrays`."""
    try:
        with ZipFile(file) as archive:
            members = _members(archive, size_of(file))
            wanted = members if names is None else names
            return {name: _array(archive, members[name]) for name in wanted}
    except Exception as error:  # damage has many names
        reason = f"{type(error).__name__}: {error!s:.200}"
        raise DataError(f"{path} is damaged ({reason})") from error


def _members(archive: ZipFile, size: int) -> dict[str, ZipInfo]:
    """Return what is in an archive by name, once it is sure that nothing grows when it is read."""
    members: dict[str, ZipInfo] = {}
    for member in archive.infolist():
        name, suffix = member.filename[:-4], member.filename[-4:]
        if suffix != ".npy" or name in members:
            raise ValueError(f"{member.filename!r:.80} is no array, or is there twice")
        if member.compress_type != ZIP_STORED or member.file_size != member.compress_size:
            raise ValueError(f"array {name!r:.80} is compressed")
        members[name] = member
    if sum(member.file_size for member in members.values()) > size:
        raise ValueError("its arrays are larger than it is")
    return members


def _array(archive: ZipFile, member: ZipInfo) -> NDArray[Any]:
    with archive.open(member) as stream:
        header = BytesIO(stream.read(_HEADER))
        if npy.read_magic(header) != (1, 0):
            raise ValueError(f"{member.filename!r:.80} is an array of another format")
        shape, fortran, dtype = npy.read_array_header_1_0(header)
        _check_plain(dtype, shape, member.file_size - header.tell(), member.filename)
        array = np.empty(shape, dtype, "F" if fortran else "C")
        _fill((array.T if fortran else array).reshape(-1).view(np.uint8), header, stream)
    _check_values(array)
    return array


def _fill(into: NDArray[np.uint8], *streams: IO[bytes]) -> None:
    """Fill an array with what is left in streams, one after the other."""
    first = 0
    for stream in streams:
        while data := stream.read(_BLOCK):
            into[first : first + len(data)] = np.frombuffer(data, np.uint8)
            first += len(data)
    if first != len(into):
        raise ValueError(f"an array has {first} bytes in place of {len(into)}")


def _check_plain(dtype: np.dtype[Any], shape: tuple[int, ...], size: int, name: str) -> None:
    if dtype.kind not in _PLAIN or dtype.itemsize == 0:
        raise ValueError(f"{name!r:.80} is an array of {dtype!s:.80}")
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != size:
        raise ValueError(f"{name!r:.80} says shape {shape!s:.80} and holds {size} bytes")


def _check_values(array: NDArray[Any]) -> None:
    if array.dtype.kind == "b" and array.view(np.uint8).max(initial=0) > 1:
        raise ValueError("a truth value is neither true nor false")
    if array.dtype.kind == "U":
        codes = array.ravel().view(np.dtype("u4").newbyteorder(array.dtype.byteorder))
        if ((codes > 0x10FFFF) | ((codes >= 0xD800) & (codes < 0xE000))).any():
            raise ValueError("a character is none, and can be shown nowhere")


def from_parts(what: Mapping[str, Any], parts: Mapping[str, NDArray[Any]]) -> Any:
    """Return what :func:`parts_of` took apart, once its parts are known to fit one another.

    Raises
    ------
    KeyError
        If a part is missing, or it is nothing of the kind.
    ValueError
        If the parts do not fit one another.
    """
    kind = what["@"]
    if kind == "array":
        return parts["value"]
    if kind == "csr":
        arrays = tuple(parts[part] for part in ("data", "indices", "indptr"))
        matrix = sparse.csr_array(arrays, shape=tuple(what["shape"]))
        matrix.check_format(full_check=True)
        return matrix
    if kind == "descriptors":
        return _descriptors(parts["values"], parts["offsets"])
    if kind == "parts":
        return _feature_parts(what, parts)
    raise KeyError(kind)


def _feature_parts(what: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> FeatureParts:
    names, kinds = what["names"], what["of"]
    if not names or len({*names}) < len(names) or not all(isinstance(n, str) for n in names):
        raise ValueError(f"features in parts called {names!r:.80}")
    parts: dict[str, Any] = {}
    for number, (name, kind) in enumerate(zip(names, kinds, strict=True)):
        if kind["@"] == "parts":
            raise ValueError(f"part {name!r:.80} is itself in parts")
        own = f"{number}."
        of_part = {n.removeprefix(own): a for n, a in arrays.items() if n.startswith(own)}
        parts[name] = from_parts(kind, of_part)
        if len(parts[name].shape) != 2:
            raise ValueError(f"part {name!r:.80} is no batch of features")
    if len({part.shape[0] for part in parts.values()}) > 1:
        raise ValueError("the parts are of different numbers of samples")
    return FeatureParts(parts)


def _descriptors(values: NDArray[Any], offsets: NDArray[Any]) -> DescriptorSets:
    if values.ndim != 2 or offsets.ndim != 1 or offsets.dtype.kind not in "iu" or not len(offsets):
        raise ValueError(f"descriptor sets of shapes {values.shape} and {offsets.shape}")
    if offsets[0] != 0 or offsets[-1] != len(values) or (np.diff(offsets) < 0).any():
        raise ValueError("the sets of descriptors do not lie end to end")
    return DescriptorSets(values, offsets)
