"""From the bytes of a message to an object with its fields. One line a message encoding."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from contextlib import redirect_stderr
from io import StringIO
from typing import Any

from mcap.decoder import DecoderFactory
from mcap.records import Channel, Schema
from mcap_ros2.decoder import DecoderFactory as Ros2DecoderFactory

from placecue.errors import DataError

Decode = Callable[[bytes], Any]


class JsonDecoderFactory(DecoderFactory):
    """Decodes JSON messages to plain dicts, whatever their schema."""

    def decoder_for(self, message_encoding: str, schema: Schema | None) -> Decode | None:
        """Return the decoder where the encoding is ``json``."""
        return json.loads if message_encoding == "json" else None


def cdr_header_stamp(data: bytes) -> int:
    """Return the stamp of a CDR message that begins with a std_msgs/Header, ns, undecoded."""
    order = "<" if data[1] & 1 else ">"
    sec, nanosec = struct.unpack_from(order + "iI", data, 4)
    return int(sec) * 1_000_000_000 + int(nanosec)


#: Factories are asked in this order.
FACTORIES: tuple[type[DecoderFactory], ...] = (Ros2DecoderFactory, JsonDecoderFactory)
#: How to read the stamp of a message that begins with a header, without decoding the rest.
HEADER_STAMPS: dict[str, Callable[[bytes], int]] = {"cdr": cdr_header_stamp}


def decoder_for(channel: Channel, schema: Schema | None) -> Decode:
    """Return what decodes the messages of a channel.

    Raises
    ------
    DataError
        If the encoding is not known or the schema does not parse.
    """
    try:
        with redirect_stderr(StringIO()):  # the parser of ROS definitions prints before it raises
            for factory in FACTORIES:
                decode = factory().decoder_for(channel.message_encoding, schema)
                if decode is not None:
                    return decode
    except Exception as error:  # schema parsers raise anything over a broken definition
        raise DataError(
            f"the schema '{schema.name if schema else ''}' of {channel.topic} does not parse: "
            f"{error}"
        ) from error
    raise DataError(
        f"{channel.topic} cannot be decoded: messages are {channel.message_encoding or 'raw'} "
        f"with a schema in {(schema.encoding if schema else '') or 'no language'}; readable are "
        "cdr with ros2msg, and json"
    )
