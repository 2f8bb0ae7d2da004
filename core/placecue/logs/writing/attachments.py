"""The attachments of a log, for its copy."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import IO

from mcap.reader import make_reader
from mcap.records import Attachment, AttachmentIndex

from placecue.limits import current_limits
from placecue.logs.mcap import linear
from placecue.logs.mcap.container import LogFile
from placecue.logs.mcap.framing import HEAD, parse

log = logging.getLogger(__name__)


def attachments_of(file: LogFile) -> Iterator[Attachment]:
    """Yield the attachments of a log; those that cannot be read, or are too large, are told."""
    if not file.contents.attachments:
        return
    found = 0
    with file.path.open("rb") as opened:
        for each in _by_index(opened) if file.contents.chunks else _by_search(opened, file.size):
            found += 1
            yield each
    lost = len(file.contents.attachments) - found
    if lost > 0:
        log.warning(
            f"{file.path}: {lost} of {len(file.contents.attachments)} attachments are left out: "
            f"they are damaged, or larger than limits.file={current_limits().file}"
        )


def _by_index(opened: IO[bytes]) -> Iterator[Attachment]:
    summary = make_reader(opened).get_summary()
    for index in [] if summary is None else summary.attachment_indexes:
        found = _read(opened, index)
        if found is not None:
            yield found


def _read(opened: IO[bytes], index: AttachmentIndex) -> Attachment | None:
    if current_limits().over("file", index.length):
        return None
    try:
        opened.seek(index.offset)
        opcode, length = HEAD.unpack(opened.read(HEAD.size))
        found = None if length > index.length else parse(opcode, opened.read(length))
    except Exception:  # a parser fed with damaged bytes may raise anything
        return None
    return found if isinstance(found, Attachment) else None


def _by_search(opened: IO[bytes], size: int) -> Iterator[Attachment]:
    # What is damaged was told when the file was opened.
    for record in linear.records(opened, size, lambda damage: None):
        if isinstance(record, Attachment):
            yield record
