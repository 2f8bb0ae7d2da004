"""The clocks of a log: that of the recorder, and those of the message headers."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence

from placecue.errors import UnusableObservation
from placecue.logs.joining.items import APART, TopicReader
from placecue.logs.mcap.container import LogFile

log = logging.getLogger(__name__)

#: So many messages of each topic say what its clock is.
SOME = 10
#: With so many, one that lies in the future is left aside.
ENOUGH = 5
#: So long is looked for them, s.
BEGINNING = 60.0
#: Transforms may be dated ahead, so that they hold until the next.
APART_OF_TRANSFORMS = 2 * APART


def measured(file: LogFile, readers: Sequence[TopicReader]) -> dict[str, int]:
    """Return how far the headers of each topic are behind the recorder's clock, ns.

    What comes late over a network says nothing of a clock, and nothing comes early: the least
    distance over some messages that have a stamp counts, one that lies in the future apart. Topics
    without any are left out.

    Parameters
    ----------
    file : LogFile
        The log.
    readers : sequence of TopicReader
        Of its topics.
    """
    of = {number: reader for reader in readers for number in reader.topic.channels}
    found: dict[str, list[int]] = {reader.topic.name: [] for reader in readers}
    seen = dict.fromkeys(found, 0)
    expected = {
        reader.topic.name: SOME if reader.topic.count is None else min(SOME, reader.topic.count)
        for reader in readers
    }
    first = None
    for message in file.messages(of) if of else ():
        name = of[message.channel_id].topic.name
        first = first or message.log_time
        if message.log_time - first > BEGINNING * 1e9 and any(found.values()):
            break
        if seen[name] >= SOME:
            continue
        seen[name] += 1
        try:
            stamp, _ = of[message.channel_id].stamp(message)
        except UnusableObservation:
            continue  # counted when the log is read
        if stamp > 0:
            found[name].append(message.log_time - stamp)
        if all(seen[each] >= count for each, count in expected.items()):
            break
    return {name: _least(offsets) for name, offsets in found.items() if offsets}


def _least(offsets: Sequence[int]) -> int:
    ordered = sorted(offsets)
    return ordered[1] if len(ordered) >= ENOUGH else ordered[0]


def set_clocks(readers: Sequence[TopicReader], behind: Mapping[str, int], driver: str) -> None:
    """Tell readers how to bring stamps to the clock of one topic.

    Parameters
    ----------
    readers : sequence of TopicReader
        Of the topics.
    behind : mapping of str to int
        How far the headers of each topic are behind the recorder's clock, ns.
    driver : str
        The topic whose clock counts.
    """
    own = behind.get(driver, 0)
    for reader in readers:
        moves = reader.role == "transform"
        reader.shift = shift_of(behind, reader.topic.name, driver, transforms=moves)
        reader.behind = own if abs(own) > APART else 0


def shift_of(behind: Mapping[str, int], topic: str, driver: str, transforms: bool) -> int:
    """Return what brings the stamps of a topic to the clock of another, ns; 0 if it is one.

    Where the other's clock is not known nothing is brought to it.
    """
    if driver not in behind:
        return 0
    own = behind.get(driver, 0)
    apart = behind.get(topic, own) - own
    return apart if abs(apart) > (APART_OF_TRANSFORMS if transforms else APART) else 0


def tell(
    readers: Sequence[TopicReader], behind: Mapping[str, int], driver: str, where: str
) -> None:
    """Warn of headers whose clock is not that of the recorder, and of what is done about it."""
    limits = {
        reader.topic.name: APART_OF_TRANSFORMS if reader.role == "transform" else APART
        for reader in readers
    }
    off = {name: offset for name, offset in behind.items() if abs(offset) > limits.get(name, APART)}
    if not off:
        return
    said = ", ".join(
        f"{name} {abs(offset) * 1e-9:.1f} s {'behind' if offset > 0 else 'ahead'}"
        for name, offset in sorted(off.items())
    )
    others = {reader.topic.name for reader in readers if reader.shift}
    brought = f"; {', '.join(sorted(others))} brought to the clock of {driver}" if others else ""
    log.warning(
        f"{where}: header stamps are not on the recorder's clock: {said}{brought}; labels without "
        "a stamp go by the recorder's clock"
    )
