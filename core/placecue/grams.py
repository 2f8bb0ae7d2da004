"""Where Gram blocks come from: straight from the kernels, or from where they were kept."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import joblib

from placecue import contracts
from placecue.features import FeatureBatch, n_samples
from placecue.folds import Rows
from placecue.guard import call
from placecue.kernel import Gram, Kernel


@dataclass(frozen=True)
class Known:
    """Some of the samples that a kernel machine was trained on.

    Parameters
    ----------
    features : batch of k samples
        As the kernel sees them.
    rows : ndarray of int64, shape (k,)
        Which of the training samples they are.
    samples : str or None
        What :meth:`Grams.known` said of all of these.
    """

    features: FeatureBatch
    rows: Rows
    samples: str | None = None


class Grams:
    """Asks the kernels, every time; :class:`KeptGrams` asks them once.

    What stands around the kernel as :class:`placecue.Extraction` stands around the cue. The one in
    use is :func:`current`.

    Attributes
    ----------
    keeps : bool
        Whether blocks that were asked for once are there afterwards.
    """

    keeps: ClassVar[bool] = False

    def known(self, features: FeatureBatch) -> str | None:
        """Return what to call n training samples later on, in :class:`Known`; None for nothing."""
        return None

    def shared(self, kernel: Kernel, a: FeatureBatch, b: FeatureBatch | None = None) -> Any:
        """Return what all settings of the kernel's light parameters share; see :meth:`Kernel`."""
        return call(kernel, "shared", *_pair(a, b))

    def gram(self, kernel: Kernel, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the kernel between ``a`` and ``b`` (``a`` without it), shape (n, m)."""
        block: Gram = call(kernel, "gram", *_pair(a, b), check=_block(a, b))
        return block

    def against(self, kernel: Kernel, features: FeatureBatch, known: Known) -> Gram:
        """Return the kernel between n samples and k of a machine's training samples, (n, k)."""
        return self.gram(kernel, features, known.features)


class KeptGrams(Grams):
    """Keeps the training samples and Gram blocks of a run, in memory.

    Machines trained on the same samples with the same kernel (other multi-class extensions, say)
    then share one block against each batch that is asked about, whichever of the samples are
    their support vectors; settings of light parameters share what these leave as it is.

    Parameters
    ----------
    most : int
        How many blocks are kept; the one that was asked for longest ago goes first.
    """

    keeps: ClassVar[bool] = True

    def __init__(self, most: int = 100) -> None:
        self.most = most
        self._batches: dict[str, FeatureBatch] = {}
        self._shared: dict[tuple[str, str, str], Any] = {}
        self._last: tuple[tuple[str, str, str], Gram] | None = None

    def digest(self, features: FeatureBatch) -> str:
        """Return what tells n samples apart from all others."""
        return str(joblib.hash(features))

    def known(self, features: FeatureBatch) -> str | None:
        """Keep n training samples, and return what they are called: a digest."""
        name = self.digest(features)
        self._batches.setdefault(name, features)
        return name

    def shared(self, kernel: Kernel, a: FeatureBatch, b: FeatureBatch | None = None) -> Any:
        """Return what the kernel shares; computed once for samples and kernel."""
        key = (_without_light(kernel), self.digest(a), "" if b is None else self.digest(b))
        # What was asked for last stands last.
        found = self._shared.pop(key) if key in self._shared else super().shared(kernel, a, b)
        self._shared[key] = found
        while len(self._shared) > self.most:
            del self._shared[next(iter(self._shared))]
        return found

    def gram(self, kernel: Kernel, a: FeatureBatch, b: FeatureBatch | None = None) -> Gram:
        """Return the kernel between ``a`` and ``b``, shape (n, m); the last one is kept."""
        key = (joblib.hash(kernel), self.digest(a), "" if b is None else self.digest(b))
        if self._last is None or self._last[0] != key:
            self._last = key, self.finished(kernel, self.shared(kernel, a, b), a, b)
        return self._last[1].copy()

    @staticmethod
    def finished(
        kernel: Kernel, shared: Any, a: FeatureBatch, b: FeatureBatch | None = None
    ) -> Gram:
        """Return the Gram block, shape (n, m), from what all settings share, checked."""
        block: Gram = call(kernel, "from_shared", shared, check=_block(a, b))
        return block

    def against(self, kernel: Kernel, features: FeatureBatch, known: Known) -> Gram:
        """Return the columns of the one block between n samples and all training samples."""
        whole = None if known.samples is None else self._batches.get(known.samples)
        if whole is None:
            return super().against(kernel, features, known)
        return self.gram(kernel, features, whole)[:, known.rows]


_plain = Grams()
_current: ContextVar[Grams] = ContextVar("placecue_grams", default=_plain)


def current() -> Grams:
    """Return where kernel machines get their Gram blocks from."""
    return _current.get()


@contextmanager
def keeping(grams: Grams) -> Iterator[Grams]:
    """Let kernel machines get their Gram blocks from ``grams`` inside the block.

    >>> with keeping(KeptGrams()):  # doctest: +SKIP
    ...     for multiclass in ("oao", "oaa", "modified_oaa"):
    ...         SVM(Chi2(), multiclass=multiclass).fit(train, labels).scores(test)
    """
    token = _current.set(grams)
    try:
        yield grams
    finally:
        _current.reset(token)


def _pair(a: FeatureBatch, b: FeatureBatch | None) -> tuple[FeatureBatch, ...]:
    return (a,) if b is None else (a, b)


def _block(a: FeatureBatch, b: FeatureBatch | None) -> Any:
    return partial(contracts.scaled, shape=(n_samples(a), n_samples(a if b is None else b)))


def _without_light(kernel: Kernel) -> str:
    """Return a digest of a fitted kernel, whatever its light parameters are."""
    copy: Any = deepcopy(kernel)
    copy.set_params(**dict.fromkeys(kernel.light_parameters))
    return str(joblib.hash(copy))
