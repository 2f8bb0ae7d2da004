"""The families of a cue's features, checked."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from placecue import contracts
from placecue.cue import Cue
from placecue.features import Families, FeatureBatch
from placecue.guard import step


def families_of(cue: Cue, features: FeatureBatch) -> Families | None:
    """Return the family of each of a cue's features, or None where it says nothing of them."""
    check = partial(contracts.families, like=features)
    made = step(cue, "families", getattr, cue, "families", check=check)
    if isinstance(made, Mapping):
        return {name: tuple(each) for name, each in made.items()}
    return None if made is None else tuple(made)
