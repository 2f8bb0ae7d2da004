"""From the label of one room to the kind of room it is."""

from __future__ import annotations

import re

#: COLD's newer labels: floor, category, number of the room, such as ``l4-2PO-1``.
FLOOR_CATEGORY_INSTANCE = re.compile(r"[A-Za-z]+\d*-(.+)-\d+")
INSTANCE = re.compile(r"-[A-Z]$")
NUMBER = re.compile(r"\d+$")


def category(label: str) -> str:
    """Return the category of a room, without what tells it from others of its kind.

    Parameters
    ----------
    label : str
        Such as ``2PO1-A``, ``CR-B`` or ``l4-2PO-1``.

    Returns
    -------
    str
        Such as ``2PO``, ``CR`` or ``2PO``; a label that would become empty is kept.
    """
    match = FLOOR_CATEGORY_INSTANCE.fullmatch(label)
    short = NUMBER.sub("", INSTANCE.sub("", match[1] if match else label))
    return short or label
