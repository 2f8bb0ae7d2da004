"""The starter as a pipeline: the laser model that is shipped, and objects where they are seen."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from placecue.components.build import build
from placecue.components.registry import Registry
from placecue.cue_model import CueModel
from placecue.observation import Observation
from placecue.pipeline import Pipeline
from placecue.source import Source, Wrapped
from placecue.starter.in_places import InPlaces
from placecue.starter.places import Places, chosen
from placecue.starter.rule import LASER, OBJECTS, LaserThenObjects
from placecue.storage.model import load_model

log = logging.getLogger(__name__)

#: The model of drawn plans.
MODEL = Path(__file__).parent / "laser"
#: The classifier that tells places by objects, and what its cue runs on.
KNOWLEDGE, RUNTIME = "knowledge", "onnxruntime"


class Starter:
    """What can be told without a model, and how.

    Parameters
    ----------
    registry : Registry
        Builds the components.
    """

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        there = OBJECTS in registry.names("cue") and KNOWLEDGE in registry.names("classifier")
        #: Whether objects can be seen: what looks for them is installed.
        self.sees_objects = there and find_spec(RUNTIME) is not None
        #: The kinds of rooms that objects are known of.
        self.kinds: tuple[str, ...] = ()
        if there:
            self.kinds = tuple(self._knowledge().layout_.classes)

    def pipeline(self, wanted: Any, *, laser: bool, image: bool) -> Pipeline:
        """Return a fitted pipeline.

        Parameters
        ----------
        wanted : sequence of str or None
            The places that the building has; None for all that are known.
        laser, image : bool
            Whether there are scans, and images.

        Raises
        ------
        UsageError
            If a place is not known.
        """
        objects = image and self.sees_objects
        places = chosen(wanted, self.kinds, objects)
        cues = {}
        if laser or not objects:
            model = load_model(MODEL, self.registry).cues[LASER]
            cues[LASER] = CueModel(model.cue, InPlaces(model.classifier, places))
        if objects:
            cue = build({"plugin": OBJECTS}, "cue", self.registry)
            # The table's corridor stays, whose share says whether laser and objects agree.
            cues[OBJECTS] = CueModel(cue, InPlaces(self._knowledge(), places))
        return Pipeline(cues, LaserThenObjects(places) if len(cues) > 1 else None)

    def _knowledge(self) -> Any:
        return build({"plugin": KNOWLEDGE}, "classifier", self.registry).untrained()


class InTerms(Wrapped):
    """A log whose labels are told in the starter's places, so that it can be scored.

    Parameters
    ----------
    source : Source
        The log.
    places : Places
        The places. Where no kind of room is told, every kind is a room.
    """

    def __init__(self, source: Source, places: Places) -> None:
        super().__init__(source)
        self.places = places
        #: Labels of the log that are none of the places, which has been said.
        self.unknown: set[str] = set()

    def __iter__(self) -> Iterator[Observation]:
        for observation in self.source:
            label = self.places.truth(observation.label)
            if label is not None and label not in self.places.classes:
                self._say_unknown(label)
            same = label == observation.label
            yield observation if same else observation.relabelled(label)

    def _say_unknown(self, label: str) -> None:
        if label not in self.unknown:
            self.unknown.add(label)
            log.warning(
                f"'{label}' in {self.name} is none of the starter's places, so that it counts as "
                f"not recognised: label_map={{{label}: PLACE}} says which it is"
            )

    def digest(self) -> str:
        """Return a digest of the log and the places."""
        return f"{self.source.digest()}-{'-'.join(self.places.classes)}"
