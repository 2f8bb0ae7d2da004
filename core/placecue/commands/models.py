"""What a command labels a log with: the model that ``model=`` names, or else the starter."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from placecue.commands.logs import open_source, set_tolerance
from placecue.commands.paths import path_of
from placecue.components.manager import Plugins
from placecue.errors import DataError, UsageError
from placecue.observation import Observation, Part
from placecue.pipeline import Pipeline
from placecue.source import Source
from placecue.starter.pipeline import InTerms, Starter
from placecue.starter.places import INSTALL, Places
from placecue.starter.rule import LASER, OBJECTS
from placecue.storage.model import load_model

log = logging.getLogger(__name__)

#: How many observations are looked at to see what a log has.
PEEK = 20
#: How many places are named when it is said what is told apart.
NAMED = 8
#: What the starter's scanners cover at least, degrees.
NARROWEST = 175.0
#: What they reach at least, m: with less, a room ends like a corridor.
SHORTEST = 5.0


def model_and_log(
    config: Mapping[str, Any], plugins: Plugins, more: Sequence[Part]
) -> tuple[Pipeline, Source]:
    """Return the pipeline of a command and the log that it is to go over.

    Parameters
    ----------
    config : mapping
        With ``model``, null for the starter, then ``places``; and all that opens a log.
    plugins : Plugins
        Builds both.
    more : sequence of str
        The parts of an observation that the command itself can use.

    Raises
    ------
    UsageError
        If there are ``places`` and a model, which has its own classes; or a place is not known.
    DataError
        If there is nothing in the log that the starter can tell places by.
    """
    if config.get("model") is None:
        return _starter(config, plugins, more)
    if config.get("places") is not None:
        raise UsageError(
            "places= is for the starter, and a model has its own classes: leave out places= or "
            "model="
        )
    pipeline = load_model(path_of(config, "model"), plugins.registry, config["other_versions"])
    set_tolerance(pipeline, config)
    return pipeline, open_source(config, plugins, parts=(*pipeline.requires, *more))


def _starter(
    config: Mapping[str, Any], plugins: Plugins, more: Sequence[Part]
) -> tuple[Pipeline, Source]:
    starter = Starter(plugins.registry)
    starter.pipeline(config.get("places"), laser=True, image=True)  # wrong words are told first
    seen: tuple[Part, ...] = ("image", "scan") if starter.sees_objects else ("scan",)
    source = open_source(config, plugins, parts=(*seen, *more))
    first = list(islice(source, PEEK))
    scans = any(each.has("scan") for each in first)
    images = any(each.has("image") for each in first)
    if not scans and not (images and starter.sees_objects):
        raise DataError(
            f"{source.name} has no laser scans among its first {len(first)} observations, and "
            f"images need placecue[deep] ({INSTALL}): the starter has nothing to tell places by; "
            "give another log, or model="
        )
    pipeline = starter.pipeline(config.get("places"), laser=scans, image=images)
    set_tolerance(pipeline, config)
    log.info(_line(pipeline, images, starter.sees_objects))
    _warn_of_scanner(first)
    return pipeline, InTerms(source, Places(pipeline.classes))


def _line(pipeline: Pipeline, images: bool, sees_objects: bool) -> str:
    """Return that the starter is used, and what would be gained without it."""
    by = {LASER: "the laser", OBJECTS: "objects in the images"}
    places = pipeline.classes
    many = len(places) > NAMED
    names = f"{len(places)} places" if many else ", ".join(places)
    told = f"no model=: the starter tells {names} by "
    told += " and ".join(by[cue] for cue in pipeline.cues)
    if not sees_objects:
        told += f"; {INSTALL} tells kinds of rooms where there is a camera"
    elif not images:
        told += "; a camera would tell kinds of rooms"
    elif many:
        told += "; name those there are, such as places=[office,kitchen,corridor]"
    return f"{told}; a model of labels of your own (placecue train) knows the building better"


def _warn_of_scanner(first: Sequence[Observation]) -> None:
    """Say where a scanner is unlike those that the starter has been made for."""
    scans = [each.scan for each in first if each.scan and each.scan.angles.size]
    if not scans:
        return
    covered = np.degrees(max(np.ptp(scan.angles) for scan in scans))
    reach = max(scan.range_max for scan in scans)
    if covered < NARROWEST:
        unlike = f"cover {covered:.0f} degrees, and the starter has been made for 180 to 360"
    elif reach < SHORTEST:
        unlike = f"reach {reach:g} m, and the starter has been made for {SHORTEST:g} m or more"
    else:
        return
    log.warning(f"the scans {unlike}: what it says of them is a guess")
