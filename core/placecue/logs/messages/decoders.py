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
from placecue.logs.messages.direct import READERS, direct_decoder

Decode = Callable[[bytes], Any]


class JsonDecoderFactory(DecoderFactory):
    """Decodes JSON messages to plain dicts, whatever their schema."""

    def decoder_for(self, message_encoding: str, schema: Schema | None) -> Decode | None:
        """Return the decoder where the encoding is ``json``."""
        return json.loads if message_encoding == "json" else None


class FieldsDecoderFactory(DecoderFactory):
    """Decodes protobuf messages to what can be read like the JSON of the same schema."""

    def decoder_for(self, message_encoding: str, schema: Schema | None) -> Decode | None:
        """Return the decoder where messages and schema are protobuf."""
        if message_encoding != "protobuf":
            return None
        from mcap_protobuf.decoder import DecoderFactory  # late: it takes a while to import

        from placecue.logs.messages.protobuf import Fields

        decode = DecoderFactory().decoder_for(message_encoding, schema)
        return None if decode is None else lambda data: Fields(decode(data))


class DirectDecoderFactory(DecoderFactory):
    """Reads ROS messages of standard definition. ROS 1 is read by nothing else.

    The usual decoders of ROS 1 run code that they generate from the definition, and a log is not
    to run code.
    """

    def decoder_for(self, message_encoding: str, schema: Schema | None) -> Decode | None:
        """Return the decoder where the definition is the standard one."""
        decode = direct_decoder(message_encoding, schema)
        if decode is None and message_encoding == "ros1" and schema is not None:
            raise ValueError(
                "it is not the definition that ROS itself has, and of ROS 1 only such are read: "
                f"{', '.join(sorted(READERS))}"
            )
        return decode


def cdr_header_stamp(data: bytes) -> int:
    """Return the stamp of a CDR message that begins with a std_msgs/Header, ns, undecoded."""
    order = "<" if data[1] & 1 else ">"
    sec, nanosec = struct.unpack_from(order + "iI", data, 4)
    return int(sec) * 1_000_000_000 + int(nanosec)


def ros1_header_stamp(data: bytes) -> int:
    """Return the stamp of a ROS 1 message that begins with a std_msgs/Header, ns, undecoded."""
    _, sec, nanosec = struct.unpack_from("<III", data)
    return int(sec) * 1_000_000_000 + int(nanosec)


#: Factories are asked in this order.
FACTORIES: tuple[type[DecoderFactory], ...] = (
    DirectDecoderFactory,
    Ros2DecoderFactory,
    FieldsDecoderFactory,
    JsonDecoderFactory,
)
#: How to read the stamp of a message that begins with a header, without decoding the rest.
HEADER_STAMPS: dict[str, Callable[[bytes], int]] = {
    "cdr": cdr_header_stamp,
    "ros1": ros1_header_stamp,
}


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
            f"{' '.join(str(error).split()) or type(error).__name__}"
        ) from error
    raise DataError(
        f"{channel.topic} cannot be decoded: messages are {channel.message_encoding or 'raw'} "
        f"with a schema in {(schema.encoding if schema else '') or 'no language'}; readable are "
        "cdr with ros2msg, ros1 with ros1msg, protobuf, and json"
    )
