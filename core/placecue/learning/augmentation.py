"""Augmented copies of training observations, checked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from placecue import contracts
from placecue.cue import Augmentation, Cue
from placecue.errors import ContractError
from placecue.guard import call, step
from placecue.observation import Observation
from placecue.ownership import provenance


def augmentations_of(cue: Cue) -> Sequence[Augmentation]:
    """Return the augmentations of a cue, checked."""
    made: Sequence[Augmentation] = call(cue, "augmentations", check=contracts.augmentations)
    return made


def augmented(cue: Cue, augment: Augmentation, observation: Observation) -> Observation:
    """Return what an augmentation of a cue makes of an observation, checked."""

    def check(made: Any) -> str | None:
        return contracts.observation(made) or _said_altered(made, observation)

    made: Observation = step(cue, "augmentation", augment, observation, check=check, at=observation)
    return made


def _said_altered(made: Observation, recorded: Observation) -> str | None:
    """Check that what is unlike the recorded observation says so: kept features go by that."""
    same = made.scan is recorded.scan and made.image_source is recorded.image_source
    if same or made.origin is None or made.origin != recorded.origin:
        return None
    return "returned other parts as if they were recorded: make copies with altered(how, ...)"


def told_apart(cue: Cue, observation: Observation) -> None:
    """Raise ContractError if two augmentations of a cue give their copies one name."""
    made = [augmented(cue, augment, observation) for augment in cue.augmentations()]
    names = [each.origin.altered for each in made if each.origin is not None]
    for name in filter(None, names):
        if names.count(name) > 1:
            raise ContractError(
                f"{provenance(cue)}: {names.count(name)} augmentations call their copies "
                f"'{name}': give each a name of its own in altered(how, ...)"
            )
