"""An MCAP file that is being written: whole at the end, or not there at all."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.records import Attachment, Channel, Message, Schema
from mcap.writer import CompressionType, Writer

from placecue.atomic import Part
from placecue.errors import DataError, UsageError, choices
from placecue.logs.messages.kinds import MessageType, Written

COMPRESSIONS = {
    "zstd": CompressionType.ZSTD,
    "lz4": CompressionType.LZ4,
    "none": CompressionType.NONE,
}


#: How ROS 2 plays a topic: the last ten, reliably; static transforms also to who comes late.
_QOS = (
    "- history: 1\n  depth: 10\n  reliability: 1\n  durability: {durability}\n"
    "  deadline: {{sec: 9223372036, nsec: 854775807}}\n"
    "  lifespan: {{sec: 9223372036, nsec: 854775807}}\n  liveliness: 1\n"
    "  liveliness_lease_duration: {{sec: 9223372036, nsec: 854775807}}\n"
    "  avoid_ros_namespace_conventions: false"
)
QOS = "offered_qos_profiles"


def qos_of(topic: str) -> dict[str, str]:
    """Return the metadata of a channel that ROS 2 asks for."""
    return {QOS: _QOS.format(durability=1 if topic.endswith("tf_static") else 2)}


def profile_of(channels: Iterable[Channel]) -> str:
    """Return the profile of a file with such channels: ros2 only where each is as ROS 2 has it."""
    honest = [each.message_encoding == "cdr" and QOS in each.metadata for each in channels]
    return "ros2" if honest and all(honest) else ""


class Output:
    """An MCAP file under a temporary name, which takes its own when it is complete.

    Parameters
    ----------
    path : str or Path
        The file to be; one that is there is replaced. Missing folders are made.
    profile : str
        Profile in the file's header.
    compression : {"zstd", "lz4", "none"}
        Of the chunks.
    chunk_size : int
        Bytes of messages in a chunk, before compression.

    Raises
    ------
    UsageError
        If the file cannot be written there, or the compression is not known.
    """

    def __init__(
        self,
        path: str | Path,
        profile: str = "",
        compression: str = "zstd",
        chunk_size: int = 2**20,
    ) -> None:
        if compression not in COMPRESSIONS:
            raise UsageError(
                f"unknown compression '{compression}': {choices(compression, COMPRESSIONS)}"
            )
        self.path = Path(path)
        self._part = Part(self.path)
        self._file = self._part.temporary.open("wb")
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, str], int] = {}
        # Of several files each has numbers of its own.
        self._copied: dict[tuple[int, int], int] = {}
        self._copied_schemas: dict[tuple[str, str, bytes], int] = {}
        self._writer = Writer(
            self._file, chunk_size=chunk_size, compression=COMPRESSIONS[compression]
        )
        self._writer.start(profile=profile, library="placecue")

    def metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        self._writer.add_metadata(name, {str(key): str(value) for key, value in values.items()})

    def write(self, stamp: int, written: Written) -> None:
        """Write a message, with its stamp as log time, ns."""
        data = written.type.serialise(written.message)
        channel = self._channel(written.topic, written.type)
        self._add(channel, stamp, data, stamp)

    def copy(
        self, message: Message, channels: Mapping[int, Channel], schemas: Mapping[int, Schema]
    ) -> None:
        """Write a message of another file as it is.

        Parameters
        ----------
        message : Message
            The message.
        channels, schemas : mapping of int to record
            Those of the other file, by id.
        """
        number = (id(channels), message.channel_id)
        if number not in self._copied:
            channel = channels[message.channel_id]
            schema = self._copied_schema(schemas.get(channel.schema_id))
            self._copied[number] = self._writer.register_channel(
                channel.topic, channel.message_encoding, schema, channel.metadata
            )
        self._add(
            self._copied[number],
            message.log_time,
            message.data,
            message.publish_time,
            message.sequence,
        )

    def _add(self, channel: int, log_time: int, data: bytes, time: int, sequence: int = 0) -> None:
        try:
            self._writer.add_message(channel, log_time, data, time, sequence)
        except OSError as error:
            raise DataError(f"cannot write {self.path}: {error.strerror}") from error

    def attach(self, attachment: Attachment) -> None:
        """Write an attachment."""
        self._writer.add_attachment(
            attachment.create_time,
            attachment.log_time,
            attachment.name,
            attachment.media_type,
            attachment.data,
        )

    def _copied_schema(self, schema: Schema | None) -> int:
        if schema is None:
            return 0
        key = (schema.name, schema.encoding, schema.data)
        if key not in self._copied_schemas:
            self._copied_schemas[key] = self._writer.register_schema(*key)
        return self._copied_schemas[key]

    def _channel(self, topic: str, type: MessageType) -> int:
        key = (topic, type.name)
        if key not in self._channels:
            if type.name not in self._schemas:
                self._schemas[type.name] = self._writer.register_schema(
                    type.name, type.schema_encoding, type.schema
                )
            metadata = qos_of(topic) if type.encoding == "cdr" else {}
            self._channels[key] = self._writer.register_channel(
                topic, type.encoding, self._schemas[type.name], metadata
            )
        return self._channels[key]

    def commit(self) -> None:
        """Finish the file and give it its name."""
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]
            self._file.close()
            self._part.commit()
        except OSError as error:
            raise DataError(f"cannot finish {self.path}: {error.strerror}") from error
        finally:
            self._part.abort()

    def abort(self) -> None:
        """Remove what was written."""
        try:
            self._file.close()
        finally:
            self._part.abort()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None:
            self.commit()
        else:
            self.abort()
