"""A log with what placecue made of it: beliefs, areas, and the map at its end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import resources
from json import dumps, loads
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from placecue.accumulator import AreaUpdate
from placecue.atomic import write_json
from placecue.belief import Belief
from placecue.errors import UnusableObservation
from placecue.faults import Faults
from placecue.logs.messages import placecue_ros
from placecue.logs.messages.foxglove_messages import message_type, number, time
from placecue.logs.messages.kinds import MessageType, Written
from placecue.logs.writing.scene import Color, belief_update, map_update, palette
from placecue.logs.writing.writer import McapWriter, can_hold
from placecue.observation import Observation
from placecue.semantic_map import SemanticMap

LAYOUT = "placecue_layout.json"

BELIEF_TOPIC = "/placecue/belief"
BELIEF_SCENE_TOPIC = "/placecue/belief_scene"
AREA_TOPIC = "/placecue/area"
MAP_TOPIC = "/placecue/map"
MAP_SCENE_TOPIC = "/placecue/map_scene"


class AnnotatedLog:
    """Writes observations with beliefs and areas to an MCAP file; a context manager.

    Foxglove and Lichtblick show it with the layout that :func:`write_layout` puts beside it.
    What placecue made is in the language of the rest. With ``encoding="json"`` it is JSON with a
    schema: ``placecue.Belief``, ``placecue.AreaUpdate``, ``placecue.SemanticMap`` and
    ``foxglove.SceneUpdate``. In ``cdr`` these are ``placecue_msgs/Belief``,
    ``placecue_msgs/AreaUpdate``, the map as JSON in a ``placecue_msgs/SemanticMap``,
    and ``foxglove_msgs/SceneUpdate``, so that tools for ROS 2 read the whole file.

    Parameters
    ----------
    path : str or Path
        The file to be.
    classes : sequence of str
        The classes that labels come from, for their colours.
    colours : mapping of str to (r, g, b), optional
        Colours by class, 0 to 1, in place of the usual ones.
    size : float
        Diameter of the nodes of the map, m; lines and texts are scaled to it.
    **options
        Options of :class:`McapWriter`, such as ``encoding`` of the observations.

    Examples
    --------
    >>> with AnnotatedLog("out.mcap", pipeline.classes) as annotated:  # doctest: +SKIP
    ...     for observation, belief, update in pipeline.label(log, accumulator):
    ...         annotated.observe(observation, belief, update)
    ...     annotated.close_with(accumulator.semantic_map())
    """

    def __init__(
        self,
        path: str | Path,
        classes: Sequence[str],
        colours: Mapping[str, Color] | None = None,
        size: float = 0.3,
        **options: Any,
    ) -> None:
        self.colours = {**palette(classes), **(colours or {})}
        self.size = size
        self.writer = McapWriter(path, **options)
        self._ros = self.writer.dialect.profile == "ros2"
        self._stamp = 0
        self._faults = Faults(str(path))

    def observe(
        self, observation: Observation, belief: Belief | None, update: AreaUpdate | None = None
    ) -> None:
        """Write one moment.

        Parameters
        ----------
        observation : Observation
            What was seen; where it cannot be written (a broken image) the belief still is.
        belief : Belief or None
            What the pipeline says of it.
        update : AreaUpdate or None
            What the accumulator made of it.
        """
        try:
            self.writer.write(observation)
        except UnusableObservation as error:
            self._faults.add("observations could not be written", str(error))
        if not can_hold(observation.stamp):
            return
        self._stamp = observation.stamp
        if belief is not None:
            told = ros_belief_message(belief) if self._ros else belief_message(belief)
            self._put(BELIEF_TOPIC, "placecue.Belief", told)
        if belief is not None and observation.pose is not None:
            shown = belief_update(belief, observation.pose, self.colours, self.size)
            self._put(BELIEF_SCENE_TOPIC, "foxglove.SceneUpdate", shown)
        if update is not None:
            told = area_message(self._stamp, update)
            told["confidence"] = float(update.confidence) if self._ros else told["confidence"]
            self._put(AREA_TOPIC, "placecue.AreaUpdate", told)

    def close_with(self, semantic_map: SemanticMap) -> None:
        """Write the map, as data and as a scene, at the time of the last observation."""
        told = semantic_map.to_json()
        self._put(MAP_TOPIC, "placecue.SemanticMap", {"json": dumps(told)} if self._ros else told)
        scene = map_update(self._stamp, semantic_map, self.colours, self.size)
        self._put(MAP_SCENE_TOPIC, "foxglove.SceneUpdate", scene)

    def _put(self, topic: str, name: str, message: dict[str, Any]) -> None:
        kind = ros_type(name) if self._ros else message_type(name)
        self.writer.output.write(self._stamp, Written(topic, kind, message))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.writer.__exit__(kind, error, trace)
        if kind is None:
            self._faults.report()


def ros_type(name: str) -> MessageType:
    """Return the ROS 2 message that stands for one of JSON."""
    package, _, message = name.partition(".")
    return placecue_ros.message_type(f"{package}_msgs/{message}")


def ros_belief_message(belief: Belief) -> dict[str, Any]:
    """Return a belief as a ``placecue_msgs/Belief``."""
    return {
        "timestamp": time(belief.stamp),
        "stamp": belief.stamp,
        "label": belief.label,
        "confidence": float(belief.confidence),
        "columns": [str(column) for column in belief.scores.layout.columns],
        "scores": belief.scores.values[0].tolist(),
        "cues_used": list(belief.cues_used),
    }


def belief_message(belief: Belief) -> dict[str, Any]:
    """Return a belief as a ``placecue.Belief``."""
    columns = belief.scores.layout.columns
    values = belief.scores.values[0].tolist()
    return {
        "timestamp": time(belief.stamp),
        "stamp": belief.stamp,
        "label": belief.label,
        "confidence": number(belief.confidence),
        "scores": {name: number(value) for name, value in zip(columns, values, strict=True)},
        "cues_used": list(belief.cues_used),
    }


def area_message(stamp: int, update: AreaUpdate) -> dict[str, Any]:
    """Return an update as a ``placecue.AreaUpdate``."""
    return {
        "timestamp": time(stamp),
        "stamp": stamp,
        "area": update.area,
        "label": update.label,
        "confidence": number(update.confidence),
        "finished": update.finished,
    }


def write_layout(folder: str | Path, frame: str = "odom") -> Path:
    """Put the layout for Foxglove and Lichtblick into a folder and return its path.

    Parameters
    ----------
    folder : str or Path
    frame : str
        The frame of the map, which stands still in the picture.
    """
    layout = loads(resources.files("placecue.logs").joinpath(LAYOUT).read_text("utf-8"))
    layout["configById"]["3D!placecue"]["followTf"] = frame
    return write_json(Path(folder) / LAYOUT, layout)
