"""One's own classes from those of a data set: renamed, merged, dropped."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

from placecue.errors import UsageError, choices

Unmapped = Literal["keep", "drop", "error"]


class LabelMap:
    """Maps labels to other labels.

    Parameters
    ----------
    names : mapping of str to str or None
        The new label of each old one. Two that get the same one are merged; None drops a label,
        so that what has it counts as unlabelled.
    unmapped : {"keep", "drop", "error"}
        What happens to labels that are not among ``names``.

    Raises
    ------
    UsageError
        If ``unmapped`` is something else, or a new label is no text.
    """

    def __init__(self, names: Mapping[str, str | None], unmapped: Unmapped = "keep") -> None:
        if unmapped not in get_args(Unmapped):
            raise UsageError(
                f"unmapped_labels={unmapped}: {choices(str(unmapped), get_args(Unmapped))}"
            )
        self.names = {str(old): _label(old, new) for old, new in names.items()}
        self.unmapped = unmapped

    def __call__(self, label: str | None) -> str | None:
        """Return the new label of an old one; None is no label.

        Raises
        ------
        UsageError
            If it has none, and that is an error.
        """
        if label is None or label in self.names:
            return None if label is None else self.names[label]
        if self.unmapped == "error":
            raise UsageError(
                f"label_map does not say what becomes of the label '{label}'; "
                f"{choices(label, self.names)}; add it, or set unmapped_labels=keep or drop"
            )
        return label if self.unmapped == "keep" else None


def _label(old: str, new: str | None) -> str | None:
    if new is None:
        return None
    if not isinstance(new, str | int | float) or not str(new).strip():
        raise UsageError(f"label_map: the new label of '{old}' is {new!r}; give a text, or null")
    return str(new).strip()
