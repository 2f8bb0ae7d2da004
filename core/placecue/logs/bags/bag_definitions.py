"""The message definitions of a bag, as text that the decoders of MCAP messages parse."""

from __future__ import annotations

from functools import cached_property

from rosbags.interfaces import Connection, ConnectionExtRosbag1, MessageDefinitionFormat
from rosbags.typesys import Stores, get_types_from_idl, get_typestore
from rosbags.typesys.store import Typestore

from placecue.errors import UsageError, choices

PREFIX = "ros2_"
IDL_RULE = "=" * 80 + "\n"


class Definitions:
    """Finds the definition of a connection's messages.

    Parameters
    ----------
    distribution : str
        ROS 2 distribution whose definitions stand in where a bag has none, such as ``humble``.

    Raises
    ------
    UsageError
        If there is no such distribution.
    """

    def __init__(self, distribution: str) -> None:
        self.distribution = distribution
        names = [each.value.removeprefix(PREFIX) for each in Stores if PREFIX in each.value]
        if distribution not in names:
            raise UsageError(
                f"source.distribution={distribution} is not known; {choices(distribution, names)}"
            )

    def of(self, connection: Connection) -> tuple[str, str, str]:
        """Return schema name, language and text; the text is empty where nothing defines it."""
        name, held = connection.msgtype, connection.msgdef
        if isinstance(connection.ext, ConnectionExtRosbag1):
            return name.replace("/msg/", "/"), "ros1msg", held.data
        if held.format == MessageDefinitionFormat.MSG:
            return name, "ros2msg", held.data
        store = self._store if held.format == MessageDefinitionFormat.NONE else _of_idl(held.data)
        known = name in store.fielddefs
        return name, "ros2msg", store.generate_msgdef(name, ros_version=2)[0] if known else ""

    @cached_property
    def _store(self) -> Typestore:
        return get_typestore(Stores(PREFIX + self.distribution))


def _of_idl(text: str) -> Typestore:
    """Return the types of a definition in IDL, one text or several under rules."""
    store = get_typestore(Stores.EMPTY)
    parts = text.split(IDL_RULE)[1:] if text.startswith(IDL_RULE + "IDL: ") else [text]
    for part in parts:
        body = part.split("\n", 1)[1] if part.startswith("IDL: ") else part
        store.register(get_types_from_idl(body))
    return store
