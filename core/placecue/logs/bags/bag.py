"""A ROS 1 or ROS 2 bag as a log: its messages as MCAP would hold them, byte for byte."""

from __future__ import annotations

import hashlib
import logging
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path

from mcap.records import Channel, Message, Schema
from rosbags import rosbag2
from rosbags.interfaces import Connection, ConnectionExtRosbag1

from placecue.errors import DataError
from placecue.logs.bags.bag_chunks import ChunkReader
from placecue.logs.bags.bag_cut import CutBag
from placecue.logs.bags.bag_definitions import Definitions
from placecue.logs.bags.bag_storage import STORAGES, files_of, missing_bytes, storage_of
from placecue.logs.bags.cut_reader import CutReader
from placecue.logs.bags.cut_storage import CutStorage
from placecue.logs.mcap.container import LogFile, check_channels, told_lost
from placecue.logs.mcap.contents import Contents
from placecue.logs.mcap.linear import Damage, describe

log = logging.getLogger(__name__)

Reader = ChunkReader | rosbag2.Reader | CutReader


class BagFile(LogFile):
    """A bag on disk, read with the ``rosbags`` library. It is opened anew for every pass.

    Everything that reads MCAP reads it: connections are given as channels, and message
    definitions as schemas.

    Parameters
    ----------
    path : str or Path
        A ROS 1 bag; the folder of a ROS 2 bag, or one storage file (``.db3``) of it.
    distribution : str
        ROS 2 distribution whose message definitions stand in where the bag has none.

    Raises
    ------
    DataError
        If it is missing, no bag, or a bag of which nothing can be read.
    UsageError
        If there is no such distribution.
    """

    def __init__(self, path: str | Path, distribution: str = "humble") -> None:
        self.path = Path(path)
        self._definitions = Definitions(distribution)
        self._storage = storage_of(self.path)
        self.size = sum(file.stat().st_size for file in files_of(self._storage))
        # What reads in place of rosbags where the index is lost, or a storage file that is MCAP.
        self._cut: CutReader | None = None
        self._mcap: LogFile | None = None
        self._told = False
        try:
            self.contents = self._contents()
        except Exception as error:  # parsers fed with damaged bytes may raise anything
            self._mcap = self._only_mcap()
            if self._mcap is None:
                self._cut = self._salvaged(error)
                self.contents = self._contents()
            else:
                self.contents = self._mcap.contents
        check_channels(self.path, len(self.contents.channels))
        self._tell_cut_storage()

    def messages(
        self, channels: Collection[int], since: int | None = None, until: int | None = None
    ) -> Iterator[Message]:
        """Yield the messages of some channels.

        In order of log time where the bag has an index, else in the order of the file. Where the
        bag is damaged they end early, which is said once.

        Parameters
        ----------
        channels : collection of int
            Ids of the wanted channels.
        since, until : int, optional
            First log time to give, and the one to stop before, ns.
        """
        if self._mcap is not None:
            yield from self._mcap.messages(channels, since, until)
            return
        last = self.contents.start
        try:
            with self._open() as reader:
                wanted = [each for each in reader.connections if each.id in channels]
                # Asked for no connection, a reader would give all.
                for connection, last, data in (
                    reader.messages(wanted, since, until) if wanted else ()
                ):
                    yield Message(connection.id, last, data, last, sequence=0)
                if isinstance(reader, ChunkReader):
                    self._tell_chunks(reader.damages)
        except Exception as error:  # parsers fed with damaged bytes may raise anything
            self._tell_damage(last, error)

    def digest(self) -> str:
        """Return a SHA-256 of the files' bytes, in hexadecimal."""
        digests = []
        for path in files_of(self._storage):
            with path.open("rb") as file:
                digests.append(hashlib.file_digest(file, "sha256").hexdigest())
        return hashlib.sha256(" ".join(digests).encode()).hexdigest()

    def _open(self) -> Reader:
        if self._cut is not None:
            return self._cut
        return rosbag2.Reader(self._storage) if self._is_ros2 else ChunkReader(self._storage)

    @property
    def _is_ros2(self) -> bool:
        return self._storage.is_dir() or self._storage.suffix in STORAGES

    def _contents(self) -> Contents:
        with self._open() as reader:
            connections, some = list(reader.connections), bool(reader.message_count)
            return Contents(
                schemas={each.id: self._schema(each) for each in connections},
                channels={each.id: _channel(each) for each in connections},
                counts=Counter({each.id: each.msgcount for each in connections}),
                start=reader.start_time if some else 0,
                end=reader.end_time - 1 if some else 0,
                metadata={"placecue": {"format": f"ROS {1 + self._is_ros2} bag"}},
            )

    def _schema(self, connection: Connection) -> Schema:
        name, language, text = self._definitions.of(connection)
        return Schema(id=connection.id, data=text.encode(), encoding=language, name=name)

    def _only_mcap(self) -> LogFile | None:
        """Return the only storage file where it is MCAP: it is read whatever it lacks."""
        stored = [each for each in files_of(self._storage) if each.suffix in STORAGES]
        return LogFile(stored[0]) if len(stored) == 1 and stored[0].suffix == ".mcap" else None

    def _salvaged(self, error: Exception) -> CutReader:
        """Return what is readable of a bag that its index does not lead to."""
        files = [each for each in files_of(self._storage) if each.suffix == ".db3"]
        cut: CutReader = CutStorage(files) if self._is_ros2 else CutBag(self._storage)
        if not cut.message_count:
            raise DataError(f"{self.path} cannot be read as a bag: {describe(error)}") from error
        seconds = (cut.end_time - cut.start_time) * 1e-9
        more = ""
        if isinstance(cut, CutBag):
            place = f", up to byte {cut.damage.offset} of {self.size}" if cut.damage else ""
            more = f"{place}; 'rosbag reindex' makes a whole bag of it"
        log.warning(
            f"{self.path} is cut off or damaged ({describe(error)}): read {cut.message_count} "
            f"messages over {seconds:.1f} s{more}"
        )
        return cut

    def _tell_cut_storage(self) -> None:
        """Warn where a file of a ROS 2 bag is shorter than it says itself to be."""
        for path in files_of(self._storage):
            missing = missing_bytes(path)
            if missing:
                log.warning(
                    f"{path} is cut off: {missing} of the {missing + path.stat().st_size} bytes "
                    "that it says to have are missing, and messages with them; what is left is read"
                )

    def _tell_chunks(self, damages: list[Damage]) -> None:
        if damages and not self._told:
            self._told = True
            lost = sum(damage.lost or 0 for damage in damages)
            log.warning(
                f"{self.path} is damaged: {len(damages)} chunks cannot be read to their end, the "
                f"first at byte {damages[0].offset} ({damages[0].reason}); {told_lost(lost)}"
            )

    def _tell_damage(self, last: int, error: Exception) -> None:
        if not self._told:
            self._told = True
            seconds = (last - self.contents.start) * 1e-9
            log.warning(
                f"{self.path} is damaged: it can be read up to {seconds:.1f} s after its beginning "
                f"({describe(error)})"
            )


def _channel(connection: Connection) -> Channel:
    """Return a connection as MCAP has it; its schema has the same number."""
    details = connection.ext
    encoding = "ros1" if isinstance(details, ConnectionExtRosbag1) else details.serialization_format
    return Channel(connection.id, connection.topic, encoding, {}, connection.id)
