"""Reads the tensors of a PyTorch state dict, and nothing else, without PyTorch.

The legacy format: five pickles (a magic number, the format's version, what machine wrote it, the
tensors by name, the names of the storages) and then the storages, each its length and its numbers.
A pickle is a program, so that the unpickler here knows three names: ``OrderedDict``, what makes a
tensor, and the types of storages, each of which is replaced by one of ours. Any other name ends
the reading before anything of it is looked up.
"""

from __future__ import annotations

import pickle
from collections import OrderedDict
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError

MAGIC = 0x1950A86A20F9469CFC6C
VERSION = 1001
STORAGES = {
    "FloatStorage": np.dtype("<f4"),
    "DoubleStorage": np.dtype("<f8"),
    "HalfStorage": np.dtype("<f2"),
    "LongStorage": np.dtype("<i8"),
    "IntStorage": np.dtype("<i4"),
}
#: Numbers in a storage; the largest of such networks has 1.3 million.
_LARGEST = 2**28


class NoStateDict(DataError):
    """A file that is not a state dict of tensors alone."""


@dataclass(frozen=True)
class _Storage:
    key: str
    dtype: np.dtype[Any]
    size: int


@dataclass(frozen=True)
class _Tensor:
    storage: _Storage
    offset: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]

    def over(self, numbers: NDArray[Any]) -> NDArray[Any]:
        """Return the tensor as an array of its own over the numbers of its storage."""
        last = sum((n - 1) * step for n, step in zip(self.shape, self.strides, strict=True))
        lowest = min((self.offset, *self.shape, *self.strides), default=0)
        if lowest < 0 or (0 not in self.shape and self.offset + last >= len(numbers)):
            raise ValueError("a tensor reaches beyond its storage")
        bytes_of = tuple(step * numbers.itemsize for step in self.strides)
        view = np.lib.stride_tricks.as_strided(numbers[self.offset :], self.shape, bytes_of)
        return np.ascontiguousarray(view)


def read_state_dict(path: Path) -> dict[str, NDArray[Any]]:
    """Return the tensors of a state dict by name.

    Parameters
    ----------
    path : Path
        A file that ``torch.save`` wrote in the legacy format.

    Raises
    ------
    DataError
        If it cannot be read, is none, or holds anything but tensors. Nothing in it is run.
    """
    try:
        with path.open("rb") as file:
            return _read(file)
    except OSError as error:
        raise NoStateDict(f"{path} cannot be read: {error.strerror or error}") from error
    except NoStateDict as error:
        raise NoStateDict(f"{path} is no state dict of tensors alone: {error}") from error
    except Exception as error:  # what a damaged pickle raises has many names
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise NoStateDict(f"{path} is no state dict of tensors alone: {reason}") from error


def _read(file: IO[bytes]) -> dict[str, NDArray[Any]]:
    magic, version, _ = (_Unpickler(file).load() for _ in range(3))
    if (magic, version) != (MAGIC, VERSION):
        raise NoStateDict("it does not begin as a legacy file of torch.save does")
    tensors, keys = _Unpickler(file).load(), _Unpickler(file).load()
    if not isinstance(tensors, OrderedDict) or not isinstance(keys, list):
        raise NoStateDict("it holds no tensors by name")
    for name, tensor in tensors.items():
        if not (isinstance(name, str) and isinstance(tensor, _Tensor)):
            raise NoStateDict(f"{name!r} is no tensor")
    storages = {tensor.storage.key: tensor.storage for tensor in tensors.values()}
    numbers = {key: _numbers(file, storages[key]) for key in keys}
    return {name: tensor.over(numbers[tensor.storage.key]) for name, tensor in tensors.items()}


def _numbers(file: IO[bytes], storage: _Storage) -> NDArray[Any]:
    """Return the numbers of the storage that comes next in a file."""
    size = int.from_bytes(file.read(8), "little")
    if size != storage.size or not 0 <= size <= _LARGEST:
        raise NoStateDict(f"a storage of {storage.size} numbers says it has {size}")
    data = file.read(size * storage.dtype.itemsize)
    return np.frombuffer(data, storage.dtype, count=size)


class _Unpickler(pickle.Unpickler):
    """Builds dictionaries of tensors; a name of anything else is refused."""

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) == ("collections", "OrderedDict"):
            return OrderedDict
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return _tensor
        if module == "torch" and name in STORAGES:
            return STORAGES[name]
        raise NoStateDict(f"it names {module}.{name}, and only tensors are read")

    def persistent_load(self, pid: Any) -> _Storage:
        kind, dtype, key, _, size, *view = pid
        if kind != "storage" or not isinstance(dtype, np.dtype) or view not in ([], [None]):
            raise NoStateDict("it refers to something that is no storage")
        return _Storage(str(key), dtype, int(size))


def _tensor(storage: Any, offset: int, shape: Any, strides: Any, *_: Any) -> _Tensor:
    if not isinstance(storage, _Storage):
        raise NoStateDict("a tensor has no storage")
    sizes, steps = tuple(map(int, shape)), tuple(map(int, strides))
    return _Tensor(storage, int(offset), sizes, steps)
