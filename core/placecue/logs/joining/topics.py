"""Which topic gives which part of an observation: chosen by schema, asked for where unclear."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from placecue.errors import DataError, UsageError, choices
from placecue.logs.adapters.lookup import adapter_for
from placecue.logs.mcap.container import Topic
from placecue.observation import PARTS, Part

#: A std_msgs/String topic is taken as labels unasked only where its name has one of these words:
#: logs are full of other strings (robot descriptions, speech, status).
LABEL_WORDS = {"label", "labels", "place", "places", "room", "rooms"}
#: Words that may follow as a step of their own: ``/room/name``.
FOLLOWING = {"name", "current", "class", "category", "data", "text", "value", "id", "raw"}
#: Words of names that have such a word and are no labels: ``/pick_and_place``, ``/place/goal``.
NO_LABEL_WORDS = frozenset(
    {
        "pick",
        "and",
        "drop",
        "count",
        "object",
        "objects",
        "grasp",
        "gripper",
        "item",
        "status",
        "state",
        "action",
        "goal",
        "result",
        "feedback",
        "command",
        "cmd",
        "error",
        "log",
        "marker",
        "markers",
        "light",
        "temperature",
        "service",
        "server",
        "request",
        "response",
        "speech",
        "chat",
    }
)

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
    others : tuple of Topic
        What could give it too, and was not taken.
    """

    part: Part
    topics: tuple[Topic, ...]
    reason: str
    others: tuple[Topic, ...] = ()

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
    candidates = [topic for topic in topics if is_candidate(part, topic)]
    others = tuple(t for t in topics if role_of(t) == part and t.count and t not in candidates)
    if len(candidates) == 1:
        return Choice(part, tuple(candidates), f"the only {part} topic", others)
    if candidates:
        raise ambiguous(part, candidates, where)
    seen = [topic for topic in topics if part == "scan" and role_of(topic) == "depth"]
    if len(seen) == 1:
        return Choice(part, tuple(seen), "a virtual scan of depth images, as there is no laser")
    if seen:
        return Choice(part, (), f"several depth topics, name one: source.scan_topic={seen[0].name}")
    if others:
        names = ", ".join(topic.name for topic in others)
        reason = f"no {part} topic by its name; there are {names}: name one, source.{part}_topic="
        return Choice(part, (), reason, others)
    return Choice(part, (), f"no {part} topic")


def ambiguous(part: Part, candidates: Sequence[Topic], where: str) -> UsageError:
    """Return the question which of several topics to take."""
    return UsageError(
        f"{where} has {len(candidates)} topics with {WORDS[part]}: {_listed(candidates)}; "
        f"choose one, such as source.{part}_topic={_largest(candidates).name}"
    )


def words_of(step: str) -> set[str]:
    """Return the words of one step of a name, in small letters: ``roomName`` has two."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", step)
    return {word for word in re.split(r"[^a-z]+", spaced.lower()) if word}


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


def is_candidate(part: Part, topic: Topic) -> bool:
    """Tell whether a topic may be taken for a part by itself, as far as its schema and name go."""
    if role_of(topic) != part or topic.count == 0:
        return False
    return not topic.schema.endswith("String") or _names_labels(topic.name)


def _names_labels(name: str) -> bool:
    steps = [words_of(step) for step in name.split("/") if step]
    if any(step & NO_LABEL_WORDS for step in steps):
        return False
    if len(steps) > 1 and steps[-1] <= FOLLOWING:
        steps.pop()
    return bool(steps) and bool(steps[-1] & LABEL_WORDS)


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
