"""Which topic gives the robot's pose: odometry, transforms, or poses that are surely its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from placecue.logs.joining.frames import is_static
from placecue.logs.joining.topics import (
    STAND_INS,
    Choice,
    ambiguous,
    choose,
    is_candidate,
    role_of,
    words_of,
)
from placecue.logs.mcap.container import Topic

#: Words in the names of poses that are not the robot's own.
OF_OTHERS = frozenset(
    {
        "goal",
        "goals",
        "object",
        "objects",
        "detected",
        "detection",
        "detections",
        "target",
        "targets",
        "marker",
        "markers",
        "tag",
        "tags",
        "waypoint",
        "waypoints",
        "plan",
        "initialpose",
        "initial",
        "person",
        "people",
        "face",
        "hand",
        "gripper",
        "grasp",
        "ee",
        "tool",
        "clicked",
        "charger",
        "dock",
        "cmd",
        "command",
        "setpoint",
        "desired",
    }
)
#: A pose topic fits where it has this share of the messages of the scans or images.
SHARE = 0.2


def choose_pose(
    topics: Sequence[Topic],
    wanted: str | None,
    where: str,
    driver: Topic | None,
    moving: Callable[[], tuple[Topic, ...]],
    fixed: Callable[[Topic], bool],
) -> Choice:
    """Choose what gives the robot's pose.

    Odometry is taken, else transforms, else a topic of poses by itself only where it is about as
    frequent as the scans or images, in a frame that a robot may move in, and by its name not the
    pose of something else. A localiser's poses, which have a covariance and a frame that may be
    fixed, rival odometry.

    Parameters
    ----------
    topics : sequence of Topic
        What the log holds.
    wanted : str or None
        The name of a topic that the user asked for.
    where : str
        Name of the log, for messages.
    driver : Topic or None
        The images or scans.
    moving : callable
        Returns the topics of transforms that place the robot in a fixed frame; none if they do
        not. It reads the log.
    fixed : callable
        Tells whether poses of a topic are in a frame that may be fixed. It reads the log.

    Raises
    ------
    UsageError
        If several topics could give it, or the wanted one is not there or of another kind.
    DataError
        If the wanted topic has no message.
    """
    if wanted is not None:
        choice = choose("pose", topics, wanted, where)
        moves = choice.topic is not None and role_of(choice.topic) == "transform"
        return replace(choice, topics=moving() or choice.topics) if moves else choice
    able = [topic for topic in topics if is_candidate("pose", topic)]
    fit = [each for each in able if _fits(each, driver)]
    moved = [each for each in able if each.schema.endswith("Odometry") and not _of_other(each)]
    odometry = _nearest(moved, driver)
    if odometry:
        rivals = [each for each in fit if "Covariance" in each.schema and each not in odometry]
        found = [*odometry, *filter(fixed, rivals)]
        reason = "odometry" if len(able) > 1 else "the only pose topic"
        return _one(found, reason, [*able, *_moving(topics)], where)
    transforms = moving()
    if transforms:
        return Choice("pose", transforms, "transforms, as there is no odometry", tuple(able))
    found = _nearest([each for each in fit if fixed(each)], driver)
    if found:
        return _one(found, "the only topic of poses that fits", able, where)
    if able:
        names = ", ".join(map(str, able))
        reason = (
            f"no topic is surely the robot's pose; of {names} name it, "
            f"source.pose_topic={able[0].name}"
        )
        return Choice("pose", (), reason, tuple(able))
    return Choice("pose", (), "no pose topic")


def _one(found: Sequence[Topic], reason: str, able: Sequence[Topic], where: str) -> Choice:
    if len(found) > 1:
        raise ambiguous("pose", found, where)
    others = tuple(each for each in able if each is not found[0])
    return Choice("pose", (found[0],), reason, others)


def _moving(topics: Sequence[Topic]) -> list[Topic]:
    return [t for t in topics if role_of(t) in STAND_INS["pose"] and t.count and not is_static(t)]


def _of_other(topic: Topic) -> bool:
    """Tell whether poses are by their name those of something else than the robot."""
    return any(words_of(step) & OF_OTHERS for step in topic.name.split("/"))


def _fits(topic: Topic, driver: Topic | None) -> bool:
    if _of_other(topic):
        return False
    if topic.count is None or driver is None or driver.count is None:
        return True
    return topic.count >= SHARE * driver.count


def _nearest(found: Sequence[Topic], driver: Topic | None) -> list[Topic]:
    """Return those whose namespace is most like that of the images or scans."""
    if driver is None or len(found) < 2:
        return list(found)
    alike = {each: _alike(each.name, driver.name) for each in found}
    most = max(alike.values())
    return [each for each in found if alike[each] == most]


def _alike(one: str, other: str) -> int:
    """Return how many steps two names have in common at their beginning."""
    count = 0
    for a, b in zip(one.split("/")[:-1], other.split("/")[:-1], strict=False):
        if a != b:
            break
        count += 1
    return count
