"""What is worked out once for an object and kept for as long as that very object lives."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Remembered(Generic[T]):
    """A function of one object whose result is kept while the object lives.

    A robot asks for one image after another against the same training images. The object must
    not be written to in between.

    Parameters
    ----------
    build : callable
        Works out the result for an object that weak references can be made to.
    """

    def __init__(self, build: Callable[[Any], T]) -> None:
        self.build = build
        self._known: dict[int, tuple[weakref.ref[Any], T]] = {}

    def __call__(self, thing: Any) -> T:
        """Return the result for ``thing``, from memory if it is there."""
        key = id(thing)
        known = self._known.get(key)
        if known is not None and known[0]() is thing:
            return known[1]
        result = self.build(thing)

        def forget(gone: weakref.ref[Any]) -> None:
            # The number may have passed to a younger object by now.
            if key in self._known and self._known[key][0] is gone:
                del self._known[key]

        self._known[key] = (weakref.ref(thing, forget), result)
        return result

    def __len__(self) -> int:
        return len(self._known)
