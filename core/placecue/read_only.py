"""Arrays that cannot be written into."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

AnyArray = TypeVar("AnyArray")


def read_only(array: AnyArray) -> AnyArray:
    """Return the same memory as an array that cannot be written into, nor be made writeable.

    The array itself stays as it is.

    Parameters
    ----------
    array : ndarray
        Anything else is returned as it is.
    """
    if not isinstance(array, np.ndarray) or _is_already(array):
        return array
    buffer: Any = array
    shown: Any
    try:
        # numpy lets nobody write through a read-only buffer; a mere view could be made writeable.
        shown = np.asarray(memoryview(buffer).toreadonly())
    except (TypeError, ValueError, BufferError):  # a type that has no buffer format, such as dates
        shown = array.view()
        shown.flags.writeable = False
    return shown  # type: ignore[no-any-return]


def _is_already(array: Any) -> bool:
    return isinstance(array.base, memoryview) and not array.flags.writeable
