"""Protobuf messages that read like the JSON of the same schema."""

from __future__ import annotations

from typing import Any

from google.protobuf.message import Message  # type: ignore[import-untyped]

#: Names that Foxglove's JSON has for the fields of google.protobuf.Timestamp.
TIMESTAMP = {"sec": "seconds", "nsec": "nanos"}


class Fields:
    """The fields of a protobuf message by name, as a mapping gives them.

    Parameters
    ----------
    message : protobuf message
        Decoded. Messages inside it are given as fields too, and lists of them as lists.
    """

    __slots__ = ("_message",)

    def __init__(self, message: Message) -> None:
        self._message = message

    def __getitem__(self, name: str) -> Any:
        try:
            value = getattr(self._message, name)
        except AttributeError:
            value = self._other_name(name)
        if isinstance(value, Message):
            return Fields(value)
        if _is_list(value) and value and isinstance(value[0], Message):
            return [Fields(each) for each in value]
        return value

    def get(self, name: str, default: Any = None) -> Any:
        """Return a field, or a default where the message has none of that name."""
        try:
            return self[name]
        except KeyError:
            return default

    def _other_name(self, name: str) -> Any:
        if name in TIMESTAMP and hasattr(self._message, TIMESTAMP[name]):
            return getattr(self._message, TIMESTAMP[name])
        raise KeyError(name)


def _is_list(value: Any) -> bool:
    return not isinstance(value, str | bytes) and hasattr(value, "__len__")
