"""Beliefs, the current area and the map on a server that Foxglove and Lichtblick connect to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from placecue.accumulator import AreaUpdate
from placecue.errors import UsageError
from placecue.free_space import Grid
from placecue.logs.messages.foxglove_messages import FoxgloveDialect, message_type
from placecue.logs.messages.kinds import BASE_FRAME, LASER_FRAME, Written
from placecue.logs.writing.annotated import (
    AREA_TOPIC,
    BELIEF_SCENE_TOPIC,
    BELIEF_TOPIC,
    MAP_SCENE_TOPIC,
    MAP_TOPIC,
    area_message,
    belief_message,
)
from placecue.logs.writing.scene import belief_update, map_update, palette
from placecue.logs.writing.writer import can_hold
from placecue.semantic_map import SemanticMap
from placecue.serving.onlooker import Moment

TF_TOPIC, SCAN_TOPIC = "/tf", "/scan"
#: What is served, by topic.
TOPICS = {
    TF_TOPIC: "foxglove.FrameTransform",
    SCAN_TOPIC: "foxglove.LaserScan",
    BELIEF_TOPIC: "placecue.Belief",
    BELIEF_SCENE_TOPIC: "foxglove.SceneUpdate",
    AREA_TOPIC: "placecue.AreaUpdate",
    MAP_TOPIC: "placecue.SemanticMap",
    MAP_SCENE_TOPIC: "foxglove.SceneUpdate",
}
#: How many messages may wait for one who does not take them; then the oldest are dropped.
BACKLOG = 256

Message = dict[str, Any]


class FoxgloveServer:
    """Serves what an annotated log holds, in JSON with schemas; an onlooker.

    Topics are those of :class:`placecue.logs.writing.annotated.AnnotatedLog`, with the robot's
    pose and scan. Clients that come late see the map when it is told of next.

    Parameters
    ----------
    classes : sequence of str
        The classes that labels come from, for their colours.
    host : str
        The address to listen at.
    port : int
        The port; 0 takes a free one.

    Attributes
    ----------
    url : str
        Where it is.

    Raises
    ------
    UsageError
        If ``foxglove-sdk`` is not installed, or nothing can be served there.
    """

    def __init__(self, classes: Sequence[str], host: str = "127.0.0.1", port: int = 8766) -> None:
        try:
            import foxglove
        except ImportError as error:
            raise UsageError(
                "serving beliefs needs placecue[live]: pip install 'placecue[live]'; or leave it "
                "out with serve=false"
            ) from error
        self._foxglove = foxglove
        context = self._context = foxglove.Context()  # without it channels say nothing
        try:
            self._server = foxglove.start_server(
                name="placecue",
                host=host,
                port=port,
                context=context,
                message_backlog_size=BACKLOG,
            )
        except Exception as error:  # one of its own, and not the same in every version
            raise UsageError(
                f"cannot serve at {host}:{port} ({error}): give another port=, or serve=false"
            ) from error
        self.url = f"ws://{host}:{self._server.port}"
        self.colours = palette(classes)
        self._dialect = FoxgloveDialect()
        self._channels = {topic: _channel(foxglove, topic, context) for topic in TOPICS}
        self._area: AreaUpdate | None = None

    def moment(self, moment: Moment) -> None:
        """Serve what was seen and what is believed."""
        observation, belief = moment.observation, moment.belief
        stamp, pose, scan = observation.stamp, observation.pose, observation.scan
        if not can_hold(stamp):
            return
        if pose is not None:
            self._moved(stamp, pose.frame, BASE_FRAME, pose)
        if scan is not None:
            self._moved(stamp, BASE_FRAME, LASER_FRAME, scan.mount)
            self._put(stamp, SCAN_TOPIC, lambda: _of(self._dialect.scan(stamp, scan)))
        if belief is not None:
            self._put(stamp, BELIEF_TOPIC, lambda: belief_message(belief))
        if belief is not None and pose is not None:
            self._put(stamp, BELIEF_SCENE_TOPIC, lambda: belief_update(belief, pose, self.colours))
        if moment.area != self._area:
            self._area = moment.area
            self._put_area(stamp)

    def map(self, stamp: int, semantic_map: SemanticMap, grid: Grid | None) -> None:
        """Serve the map, as data and as a scene; and the area for those who came since."""
        if not can_hold(stamp):
            return
        self._put(stamp, MAP_TOPIC, semantic_map.to_json)
        self._put(stamp, MAP_SCENE_TOPIC, lambda: map_update(stamp, semantic_map, self.colours))
        self._put_area(stamp)

    def end(self) -> None:
        """Tell viewers that the run has ended."""
        level = self._foxglove.websocket.StatusLevel.Info
        self._server.publish_status("placecue: the run has ended", level)

    def close(self) -> None:
        """Serve no more."""
        self._server.stop()

    def _put_area(self, stamp: int) -> None:
        area = self._area
        if area is not None:
            self._put(stamp, AREA_TOPIC, lambda: area_message(stamp, area))

    def _moved(self, stamp: int, parent: str, child: str, pose: Any) -> None:
        made = self._dialect.transform
        self._put(stamp, TF_TOPIC, lambda: _of(made(stamp, parent, child, pose, static=False)))

    def _put(self, stamp: int, topic: str, message: Callable[[], Message]) -> None:
        channel = self._channels[topic]
        if channel.has_sinks():  # or nobody listens, and nothing need be made
            channel.log(message_type(TOPICS[topic]).serialise(message()), log_time=stamp)


def _of(written: Written) -> Message:
    return written.message


def _channel(foxglove: Any, topic: str, context: Any) -> Any:
    kind = message_type(TOPICS[topic])
    schema = foxglove.Schema(name=kind.name, encoding=kind.schema_encoding, data=kind.schema)
    return foxglove.Channel(topic, message_encoding=kind.encoding, schema=schema, context=context)
