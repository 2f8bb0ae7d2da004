"""How evenly the messages of a log come: the largest gap of each topic."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from placecue.logs.mcap import indexed
from placecue.logs.mcap.container import LogFile, Topic


@dataclass(frozen=True, slots=True)
class Gap:
    """The longest time without a message of a topic.

    Parameters
    ----------
    seconds : float
        How long, s.
    start : int
        Log time of the message before it, ns.
    """

    seconds: float
    start: int


def largest_gaps(file: LogFile, topics: Sequence[Topic]) -> dict[str, Gap]:
    """Return the largest gap of each topic that has two messages or more, by its name.

    The index of the messages is enough, chunk by chunk; a file without one is read through.
    """
    of = {number: topic.name for topic in topics for number in topic.channels}
    newest: dict[str, int] = {}
    gaps: dict[str, Gap] = {}
    for stamps in message_times(file):
        for name, times in _by_name(stamps, of).items():
            for time in sorted(times):
                before = newest.get(name, time)
                newest[name] = max(before, time)
                seconds = max(time - before, 0) * 1e-9
                if seconds > (gaps[name].seconds if name in gaps else -1.0) and before != time:
                    gaps[name] = Gap(seconds, before)
    return gaps


def _by_name(stamps: Mapping[int, list[int]], of: Mapping[int, str]) -> dict[str, list[int]]:
    found: dict[str, list[int]] = {}
    for channel, times in stamps.items():
        if channel in of:
            found.setdefault(of[channel], []).extend(times)
    return found


def message_times(file: LogFile) -> Iterator[dict[int, list[int]]]:
    """Yield log times by channel, those of one chunk or one message together."""
    chunks = sorted(file.contents.chunks, key=lambda chunk: chunk.message_start_time)
    if chunks and all(chunk.message_index_offsets for chunk in chunks):
        with file.path.open("rb") as opened:
            found = [indexed.times(opened, chunk) for chunk in chunks]
        if None not in found:
            yield from (each for each in found if each is not None)
            return
    for message in file.messages(file.contents.channels):
        yield {message.channel_id: [message.log_time]}
