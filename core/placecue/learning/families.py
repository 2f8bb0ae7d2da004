"""The families of a cue's features, checked."""

from __future__ import annotations

from functools import partial

from placecue import contracts
from placecue.cue import Cue
from placecue.features import FeatureBatch
from placecue.guard import step


def families_of(cue: Cue, features: FeatureBatch) -> tuple[str, ...] | None:
    """Return the family of each of a cue's features, or None where it says nothing of them."""
    check = partial(contracts.families, like=features)
    made = step(cue, "families", getattr, cue, "families", check=check)
    return None if made is None else tuple(made)
