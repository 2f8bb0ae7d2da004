"""What the methods of components promise to return.

Each function returns None, or what is wrong, such as ``returned 1 row for 3 samples``: a check for
:func:`placecue.guard.call`.
"""

from __future__ import annotations

from placecue.contracts.features import batch, families, features, finite
from placecue.contracts.numbers import gram, scaled, scores, trained
from placecue.contracts.observations import (
    augmentations,
    camera,
    count,
    fits,
    image,
    metadata,
    observation,
    scan,
    stamp,
    text,
    texts,
)
from placecue.contracts.space import area_update, behind, crossing, pose, semantic_map
from placecue.folds import promised as folds

__all__ = [
    "area_update",
    "augmentations",
    "batch",
    "behind",
    "camera",
    "count",
    "crossing",
    "families",
    "features",
    "finite",
    "fits",
    "folds",
    "gram",
    "image",
    "metadata",
    "observation",
    "pose",
    "scaled",
    "scan",
    "scores",
    "semantic_map",
    "stamp",
    "text",
    "texts",
    "trained",
]
