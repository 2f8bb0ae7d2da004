"""Which topic gives which part of an observation: chosen by schema, asked for where unclear."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from placecue.errors import DataError, UsageError, choices
from placecue.logs.adapters.lookup import adapter_for
from placecue.logs.mcap.container import Topic
from placecue.observation import PARTS, Part

#: A std_msgs/String topic is taken as labels unasked only where its name has one of these words:
#: logs are full of other strings (robot descriptions, speech, status).
LABEL_WORDS = ("label", "place", "room")

#: What else may give a part, where it is asked for or there is nothing better.
STAND_INS: Mapping[str, tuple[str, ...]] = {"pose": ("transform",), "scan": ("depth",)}

WORDS: Mapping[str, str] = {
    "image": "an image",
    "scan": "a laser scan",
    "pose": "a pose",
    "label": "a label",
}


@dataclass(frozen=True, slots=True)
class Choice:
    """Which topic gives a part, and why.

    Parameters
    ----------
    part : {"image", "scan", "pose", "label"}
        The part.
    topics : tuple of Topic
        One topic; none where the part is missing; several where a pose comes from transforms.
    reason : str
        Why, in a few words.
    """

    part: Part
    topics: tuple[Topic, ...]
    reason: str

    @property
    def topic(self) -> Topic | None:
        """The topic, or None."""
        return self.topics[0] if self.topics else None


def role_of(topic: Topic) -> str | None:
    """Return what the messages of a topic can give, or None where there is no adapter.

    Depth images give ``depth``, which is a scan where there is no laser.
    """
    if topic.depth:
        return "depth"
    adapter = adapter_for(topic.encoding, topic.schema)
    return None if adapter is None else adapter.role


def transforms(topics: Sequence[Topic]) -> tuple[Topic, ...]:
    """Return the topics that carry transforms between frames."""
    return tuple(topic for topic in topics if role_of(topic) == "transform" and topic.count != 0)


def choose(part: Part, topics: Sequence[Topic], wanted: str | None, where: str) -> Choice:
    """Choose the topic that gives a part.

    Parameters
    ----------
    part : {"image", "scan", "pose", "label"}
        The part.
    topics : sequence of Topic
        What the log holds.
    wanted : str or None
        The name of a topic that the user asked for.
    where : str
        Name of the log, for messages.

    Raises
    ------
    UsageError
        If several topics could give the part, or the wanted one is not there or of another kind.
    DataError
        If the wanted topic has no message.
    """
    if wanted is not None:
        return _wanted(part, topics, wanted, where)
    candidates = [topic for topic in topics if _is_candidate(part, topic)]
    if len(candidates) == 1:
        return Choice(part, tuple(candidates), f"the only {part} topic")
    if candidates:
        raise UsageError(
            f"{where} has {len(candidates)} topics with {WORDS[part]}: {_listed(candidates)}; "
            f"choose one, such as source.{part}_topic={_largest(candidates).name}"
        )
    seen = [topic for topic in topics if part == "scan" and role_of(topic) == "depth"]
    if len(seen) == 1:
        return Choice(part, tuple(seen), "a virtual scan of depth images, as there is no laser")
    if seen:
        return Choice(part, (), f"several depth topics, name one: source.scan_topic={seen[0].name}")
    moving = [t for t in transforms(topics) if part == "pose" and "static" not in t.name]
    if moving:
        return Choice(part, tuple(moving), "transforms, as there is no pose topic")
    return Choice(part, (), f"no {part} topic")


def _wanted(part: Part, topics: Sequence[Topic], wanted: str, where: str) -> Choice:
    option = f"source.{part}_topic={wanted}"
    named = [topic for topic in topics if topic.name == wanted]
    if not named:
        raise UsageError(
            f"{option}: no such topic in {where}; {choices(wanted, (t.name for t in topics))}"
        )
    roles = {part, *STAND_INS.get(part, ())}
    fitting = [topic for topic in named if role_of(topic) in roles]
    if not fitting:
        others = [topic for topic in topics if role_of(topic) in roles]
        raise UsageError(
            f"{option}: {wanted} of {where} ({named[0].encoding} {named[0].schema}) cannot give "
            f"{WORDS[part]}; topics that can: {_listed(others) or 'none'}"
        )
    if all(topic.count == 0 for topic in fitting):
        raise DataError(f"{option}: {wanted} of {where} holds no message")
    return Choice(part, (max(fitting, key=lambda topic: topic.count or 0),), "asked for")


def _is_candidate(part: Part, topic: Topic) -> bool:
    if role_of(topic) != part or topic.count == 0:
        return False
    is_text = topic.schema.endswith("String")
    return not is_text or any(word in topic.name.lower() for word in LABEL_WORDS)


def _listed(topics: Sequence[Topic]) -> str:
    return ", ".join(str(topic) for topic in topics)


def _largest(topics: Sequence[Topic]) -> Topic:
    return max(topics, key=lambda topic: topic.count or 0)


def check_parts(parts: Collection[str]) -> tuple[Part, ...]:
    """Return the wanted parts in their usual order.

    Raises
    ------
    UsageError
        If one is not known, or neither images nor scans are wanted.
    """
    for part in parts:
        if part not in PARTS:
            raise UsageError(
                f"source.parts: '{part}' is no part of an observation; {choices(part, PARTS)}"
            )
    if "image" not in parts and "scan" not in parts:
        raise UsageError("source.parts must have image or scan: observations are made of them")
    return tuple(part for part in PARTS if part in parts)
