"""The frames of the Foxglove WebSocket protocol, as far as one who only listens needs them.

https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md. The subprotocols
``foxglove.websocket.v1`` (foxglove_bridge up to 2025, ws-protocol's own servers) and
``foxglove.sdk.v1`` (foxglove-sdk, foxglove_bridge since) are alike in these frames.
"""

from __future__ import annotations

import binascii
import json
import struct
from base64 import b64decode
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from placecue.errors import DataError
from placecue.nesting import check_depth

#: In the order in which they are offered.
SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
#: Opcode of a message, the subscription it is for, its time (ns).
MESSAGE = struct.Struct("<BIQ")
MESSAGE_DATA = 1
#: The language of the schema where a server does not say it, by the encoding of messages.
LANGUAGES = {"json": "jsonschema", "protobuf": "protobuf", "ros1": "ros1msg", "cdr": "ros2msg"}
#: Schemas that are no text come in base64.
BINARY = frozenset({"protobuf", "flatbuffer"})


@dataclass(frozen=True, slots=True)
class Advertised:
    """A channel that a server has.

    Parameters
    ----------
    id : int
        The server's number for it.
    topic, encoding : str
        Its topic, and how messages are encoded.
    schema_name, schema_encoding : str
        Name and language of the schema.
    schema : bytes
        Its text, or what stands for it.
    """

    id: int
    topic: str
    encoding: str
    schema_name: str
    schema_encoding: str
    schema: bytes


@dataclass(frozen=True, slots=True)
class Advertisement:
    """Channels that a server has from now on."""

    channels: tuple[Advertised, ...]


@dataclass(frozen=True, slots=True)
class Withdrawal:
    """Numbers of channels that a server has no more."""

    ids: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Data:
    """A message: the subscription it is for, when it was sent (ns), and its bytes."""

    subscription: int
    time: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Status:
    """What a server has to say to a person; level 0 is a remark, 1 a warning, 2 an error."""

    level: int
    message: str


Event = Advertisement | Withdrawal | Data | Status


class BadFrame(DataError):
    """A frame that makes no sense."""


def read(frame: str | bytes) -> Event | None:
    """Return what a server says in a frame; None where it is of no interest here.

    Raises
    ------
    BadFrame
        If it is none that the protocol has.
    """
    return _binary(frame) if isinstance(frame, bytes) else _text(frame)


def subscription(numbers: Iterable[tuple[int, int]]) -> str:
    """Return the frame that asks for messages, of pairs of our number and the channel's."""
    asked = [{"id": own, "channelId": channel} for own, channel in numbers]
    return json.dumps({"op": "subscribe", "subscriptions": asked})


def unsubscription(numbers: Iterable[int]) -> str:
    """Return the frame that asks for no more messages, of our numbers."""
    return json.dumps({"op": "unsubscribe", "subscriptionIds": list(numbers)})


def _binary(frame: bytes) -> Data | None:
    if not frame:
        raise BadFrame("an empty frame")
    if frame[0] != MESSAGE_DATA:
        return None  # the time, answers of services
    if len(frame) < MESSAGE.size:
        raise BadFrame(f"a message of {len(frame)} bytes, of which its head alone takes 13")
    _, number, time = MESSAGE.unpack_from(frame)
    if time >= 2**63:
        raise BadFrame(f"a message at {time} ns")
    return Data(number, time, frame[MESSAGE.size :])


def _text(frame: str) -> Event | None:
    try:
        check_depth(frame, "a frame")
        told = json.loads(frame)
    except (ValueError, RecursionError) as error:
        raise BadFrame(f"a text that is no JSON: {error}") from error
    except DataError as error:
        raise BadFrame(str(error)) from error
    if not isinstance(told, dict) or not isinstance(told.get("op"), str):
        raise BadFrame("JSON that is no object with an op")
    if told["op"] == "advertise":
        return Advertisement(tuple(map(_channel, _list(told, "channels"))))
    if told["op"] == "unadvertise":
        return Withdrawal(tuple(_number(each, "an id") for each in _list(told, "channelIds")))
    if told["op"] == "status":
        return Status(_number(told.get("level"), "a level"), _string(told, "message"))
    return None  # what a server is called, its services and parameters


def _channel(told: Any) -> Advertised:
    if not isinstance(told, dict):
        raise BadFrame(f"a channel that is {type(told).__name__} and no object")
    encoding = _string(told, "encoding")
    language = _string(told, "schemaEncoding") or LANGUAGES.get(encoding, "")
    schema = _string(told, "schema")
    return Advertised(
        _number(told.get("id"), "the id of a channel"),
        _string(told, "topic"),
        encoding,
        _string(told, "schemaName"),
        language,
        _decoded(schema) if language in BINARY else schema.encode("utf-8", "replace"),
    )


def _decoded(schema: str) -> bytes:
    try:
        return b64decode(schema, validate=True)
    except (binascii.Error, ValueError) as error:
        raise BadFrame(f"a schema that is no base64: {error}") from error


def _list(told: dict[str, Any], key: str) -> list[Any]:
    found = told.get(key)
    if not isinstance(found, list):
        raise BadFrame(f"{told['op']} without a list of {key}")
    return found


def _string(told: dict[str, Any], key: str) -> str:
    found = told.get(key)
    if found is None:
        return ""
    if not isinstance(found, str):
        raise BadFrame(f"{key} that is {type(found).__name__} and no text")
    return found


def _number(found: Any, what: str) -> int:
    if not isinstance(found, int) or isinstance(found, bool) or not 0 <= found < 2**64:
        raise BadFrame(f"{what} that is {str(found)[:20]!r}")
    return found
