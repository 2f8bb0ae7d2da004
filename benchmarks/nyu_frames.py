"""The frames of NYU Depth v2 in nested folds that part no scene.

    for fold in outer_folds(Path(os.environ["PLACECUE_DATA"]), ROOMS["four"]):
        pipeline = Pipeline(cues, integrator, folds=Scenes()).fit(fold.training)
        beliefs = list(pipeline.beliefs(fold.held_out))

What is trained cuts its own folds (searches, integrator, "unknown") at scenes too, as long as its
``folds`` is :class:`placecue.Scenes`. ``fold.held_out.labels`` and ``.scenes`` of all folds
together are what :class:`placecue.evaluation.group_bootstrap.GroupBootstrap` takes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from hydra import compose, initialize_config_module
from numpy.typing import NDArray

from placecue import Observation, Rows, Scenes
from placecue.components.build import build, plain
from placecue.components.manager import load_plugins
from placecue.components.options import register_with_hydra
from placecue.folds import cut
from placecue.learning.grouping import groups_of
from placecue.source import guarded

FOUR = ("bathroom", "bedroom", "kitchen", "living_room")
#: The classes of at least 20 frames, and those of them that a prototype had scored.
ROOMS = {
    "eight": (*FOUR, "classroom", "dining_room", "home_office", "office"),
    "four": FOUR,
}


class Frames:
    """Some labelled observations, to be iterated as often as needed; decoded images are not kept.

    Parameters
    ----------
    observations : sequence of Observation
    """

    def __init__(self, observations: Sequence[Observation]) -> None:
        self.observations = observations
        self.labels = np.array([each.label for each in observations])
        self.scenes = np.array([each.scene for each in observations])

    def __iter__(self) -> Iterator[Observation]:
        return (each.relabelled(each.label) for each in self.observations)

    def __len__(self) -> int:
        return len(self.observations)

    def take(self, rows: Rows) -> Frames:
        """Return some of them."""
        return Frames([self.observations[row] for row in rows])

    def groups(self) -> NDArray[np.int64] | None:
        """Return the log and the scene of each."""
        return groups_of([each.origin for each in self.observations], self.scenes.tolist())


class OuterFold(NamedTuple):
    """Frames to train on, of which nothing else is held out, and frames to score."""

    training: Frames
    held_out: Frames


def frames(data: Path, rooms: Sequence[str], **parameters: Any) -> Frames:
    """Return the frames of some rooms.

    Parameters
    ----------
    data : Path
        The folder of recorded data.
    rooms : sequence of str
        Their classes.
    **parameters
        Of the source ``nyuv2``, in place of what is shipped.
    """
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        words = ["source=nyuv2", "cue=laser", "integrator=none", "log=here"]
        config = plain(compose("train", words))["source"]
    own = {"path": str(data / "nyuv2"), "classes": list(rooms)}
    registry = load_plugins(built_ins_only=True).registry
    # Behind the guard frames know their origin, by which features are kept between folds.
    return Frames(list(guarded(build({**config, **own, **parameters}, "source", registry))))


def outer_folds(
    data: Path, rooms: Sequence[str], n_folds: int = 5, **parameters: Any
) -> Iterator[OuterFold]:
    """Yield the frames of some rooms in folds of whole scenes; see :func:`frames`."""
    of_rooms = frames(data, rooms, **parameters)
    for training, held_out in cut(Scenes(n_folds), of_rooms.labels, None, of_rooms.groups()):
        yield OuterFold(of_rooms.take(training), of_rooms.take(held_out))
