"""Gram blocks that are kept between runs and shared by processes, by samples and kernel.

``CACHE/grams/KERNEL-KEY/g-A-B.npz`` is the block between two batches with these digests, or what
all settings of the kernel's light parameters share of it. A block serves both ways round: which
way it is computed is decided by the digests, so that it is the same to the bit whoever asks first.
"""

from __future__ import annotations

import hashlib
import json
import logging
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import Any
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, PlacecueError
from placecue.features import FeatureBatch
from placecue.grams import KeptGrams
from placecue.kernel import Gram, Kernel
from placecue.storage import cache_folder
from placecue.storage.arrays import parts_of, read_arrays, write_arrays

FOLDER = "grams"
#: Blocks, or what they share, that are held in memory.
HELD = 2

log = logging.getLogger(__name__)


class StoredGrams(KeptGrams):
    """Keeps the Gram blocks of kernels that learn nothing in a folder.

    Blocks of others, and where the folder cannot be written to, are kept in memory alone. Digests
    are worked out once for each batch, which must stay as it is.

    Parameters
    ----------
    cache : str or Path
        The folder of the feature cache.
    """

    def __init__(self, cache: str | Path) -> None:
        super().__init__(HELD)
        self.folder = Path(cache) / FOLDER
        self._lights: dict[str, dict[str, Kernel]] = {}
        self._writable = True
        self._digests: dict[int, tuple[ref[FeatureBatch], str]] = {}

    def digest(self, features: FeatureBatch) -> str:
        """Return a digest of n samples, the same in every process."""
        known = self._digests.get(id(features))
        if known is None or known[0]() is not features:  # another one may have its id after it
            known = self._digests[id(features)] = ref(features), _digest(features)
        return known[1]

    def gram(self, kernel: Kernel, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the kernel between ``a`` and ``b``, shape (n, m), computed once for all runs."""
        if _has_learned(kernel):
            return super().gram(kernel, a, b)
        names = self.digest(a), self.digest(a if b is None else b)
        if b is not None and names[0] > names[1]:
            return np.ascontiguousarray(self._block(kernel, b, a, names[::-1]).T)
        return self._block(kernel, a, b, names)

    def _block(
        self, kernel: Kernel, a: FeatureBatch, b: FeatureBatch | None, names: tuple[str, ...]
    ) -> Gram:
        alike = self._lights.setdefault(_key(kernel, light=False), {})
        alike.setdefault(_key(kernel), deepcopy(kernel))
        name = f"g-{names[0]}-{names[1] if b is not None else 'itself'}.npz"
        shared, block = (
            self._kept(kernel, name, light=False),
            self._kept(kernel, name, light=True),
        )
        if block is not None:
            return block
        if shared is not None:
            return self.finished(kernel, shared, a, b)
        shared = super().shared(kernel, a, b)
        if isinstance(shared, np.ndarray):
            self._keep(kernel, name, shared, light=False)
        else:  # too large to keep: every setting that was asked for so far is computed at once
            for other in alike.values():
                self._keep(other, name, self.finished(other, shared, a, b), light=True)
        return self.finished(kernel, shared, a, b)

    def _kept(self, kernel: Kernel, name: str, *, light: bool) -> NDArray[Any] | None:
        path = self._folder(kernel, light=light) / name
        try:
            return read_arrays(path)["block"] if path.is_file() else None
        except (DataError, KeyError):
            return None  # damaged: it is computed anew

    def _keep(self, kernel: Kernel, name: str, block: NDArray[Any], *, light: bool) -> None:
        if not self._writable:
            return
        folder = self._folder(kernel, light=light)
        try:
            cache_folder.describe(folder, _about(kernel, light=light))
            write_arrays(folder / name, {"block": block})
        except PlacecueError as error:
            self._writable = False
            log.warning(f"Gram blocks are not kept ({error}): give cache.folder=PATH")
        with suppress(OSError):
            cache_folder.touch(folder)

    def _folder(self, kernel: Kernel, *, light: bool) -> Path:
        return self.folder / f"{type(kernel).__name__.lower()}-{_key(kernel, light=light)}"


def _has_learned(kernel: Any) -> bool:
    """Tell whether a kernel, or one inside it, has learned anything from samples."""
    values = vars(kernel)
    if any(name.endswith("_") for name in values):
        return True
    inside = [each for each in values.values() if isinstance(each, Kernel)]
    inside += [k for each in values.values() if isinstance(each, (list, tuple)) for k in each
               if isinstance(k, Kernel)]  # fmt: skip
    return any(map(_has_learned, inside))


def _about(kernel: Kernel, *, light: bool) -> dict[str, Any]:
    kind = type(kernel)
    return {
        "cue": f"kernel {kind.__name__}",
        "log": "Gram blocks",
        "version": kernel.version,
        "parameters": _parameters(kernel, light=light),
        "changed": {},
    }


def _parameters(kernel: Kernel, *, light: bool) -> dict[str, Any]:
    """Return what a kernel's blocks depend on; of kernels inside it, too."""
    left_out = () if light else kernel.light_parameters
    found = {}
    for name, value in sorted(kernel.get_params(deep=True).items()):
        if name in left_out or name in ("memory", "n_jobs"):
            continue
        if isinstance(value, Kernel):
            value = f"{type(value).__module__}.{type(value).__qualname__} {value.version}"
        found[name] = value
    return found


def _key(kernel: Kernel, *, light: bool = True) -> str:
    kind = type(kernel)
    told = [f"{kind.__module__}.{kind.__qualname__}", kernel.version,
            _parameters(kernel, light=light)]  # fmt: skip
    return hashlib.sha256(json.dumps(told, sort_keys=True, default=repr).encode()).hexdigest()[:16]


def _digest(features: FeatureBatch) -> str:
    """Return a digest of features, the same in every process."""
    apart = parts_of(features)
    assert apart is not None  # or it is no batch of features
    what, arrays = apart
    found = hashlib.blake2b(json.dumps(what, sort_keys=True).encode(), digest_size=12)
    for name, array in sorted(arrays.items()):
        found.update(f"{name} {array.dtype} {array.shape}".encode())
        found.update(np.ascontiguousarray(array).data)
    return found.hexdigest()
