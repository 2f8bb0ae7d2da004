"""What cues cost: the time from an observation to scores, measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import islice
from statistics import median
from time import perf_counter

from placecue.cue_model import CueModel
from placecue.extraction import Extraction
from placecue.observation import Observation

#: So many observations are timed of each cue; the first is extracted twice, to warm up.
TIMED = 15


def measured(
    models: Mapping[str, CueModel], observations: Iterable[Observation]
) -> dict[str, float]:
    """Return what each cue takes for one observation, ms: the median over a few.

    Parameters
    ----------
    models : mapping of str to CueModel
        Fitted.
    observations : iterable of Observation
        As many as it takes are read; each cue is extracted anew, kept features do not count.
    """
    timed: dict[str, list[float]] = {name: [] for name in models}
    plain = Extraction()
    for observation in islice(observations, 10 * TIMED):
        for name, model in models.items():
            if len(timed[name]) <= TIMED and all(map(observation.has, model.cue.requires)):
                # Each decodes the image anew: whichever comes first would pay for all.
                fresh = observation.relabelled(observation.label)
                time = _time(model, fresh, plain)
                timed[name] += [] if time is None else [time]
        if all(len(times) > TIMED for times in timed.values()):
            break
    return {name: median(times[1:] or times or [0.0]) for name, times in timed.items()}


def _time(model: CueModel, observation: Observation, extraction: Extraction) -> float | None:
    """Return how long one observation takes, ms; None where the cue makes nothing of it."""
    began = perf_counter()
    found = extraction.extract(model.cue, [observation], skip=True)
    if found.features is None:
        return None
    model.tried(found.features, skip=True)
    return 1000 * (perf_counter() - began)
