"""Scores of single-cue models, kept in the folder of a run for all methods that join them.

``FOLDER/scores/DIGEST.npz`` is what one model says of one part of a recording. Files are written
whole, so that a killed run leaves what is finished, and hold arrays and JSON only.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.components.build import build, describe
from placecue.components.registry import Registry
from placecue.errors import DataError
from placecue.scores import Layout, Probabilities, Scores
from placecue.storage.arrays import read_arrays, write_arrays

FOLDER = "scores"


@dataclass(frozen=True)
class Said:
    """What a single-cue model says of n labelled samples that it was not trained on.

    Parameters
    ----------
    scores : Scores
        Shape (n, V); NaN where it says nothing.
    labels : ndarray of str, shape (n,)
        The truth.
    stamps : ndarray of int64, shape (n,)
        Times, ns.
    positions : ndarray of int64, shape (n,)
        Which observations of the recording they are.
    groups : ndarray of int64, shape (n,) or (n, 2), or None
        What belongs together.
    scale : float
        The root mean square of what the model says of the samples that its parameters were chosen
        on, or else of those that it was trained on.
    cost : float
        What a sample takes, ms; NaN where nobody asked.
    seconds : mapping of str to float
        What training and testing took.
    settings : mapping
        What a parameter search chose.
    """

    scores: Scores
    labels: NDArray[np.str_]
    stamps: NDArray[np.int64]
    positions: NDArray[np.int64]
    groups: NDArray[np.int64] | None = None
    scale: float = 1.0
    cost: float = float("nan")
    seconds: Mapping[str, float] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)

    def of_one_scale(self) -> Said:
        """Return the same with outputs of one scale, which models of other parameters share too.

        Probabilities and other outputs of a unit of their own stay as they are.
        """
        if isinstance(self.scores.layout, Probabilities) or self.scale in (0.0, 1.0):
            return self
        values = self.scores.values / self.scale
        return replace(self, scores=Scores(values, self.scores.layout), scale=1.0)


class ScoresStore:
    """The scores in a folder.

    Parameters
    ----------
    folder : Path
        That of the run.
    registry : Registry
        Names layouts, and builds them.
    """

    def __init__(self, folder: Path, registry: Registry) -> None:
        self.folder = folder / FOLDER
        self.registry = registry

    def path(self, digest: str) -> Path:
        """Return the file of some scores."""
        return self.folder / f"{digest}.npz"

    def __contains__(self, digest: str) -> bool:
        return self.path(digest).is_file()

    def save(self, digest: str, said: Said) -> None:
        """Keep scores under a digest."""
        about = {
            "layout": describe(said.scores.layout, self.registry),
            "scale": said.scale,
            "cost": said.cost,
            "seconds": dict(said.seconds),
            "settings": dict(said.settings),
        }
        arrays: dict[str, NDArray[Any]] = {
            "about": np.frombuffer(json.dumps(about, default=str).encode(), np.uint8),
            "values": said.scores.values,
            "labels": np.asarray(said.labels, dtype=np.str_),
            "stamps": said.stamps,
            "positions": said.positions,
        }
        if said.groups is not None:
            arrays["groups"] = said.groups
        write_arrays(self.path(digest), arrays)

    def load(self, digest: str) -> Said:
        """Return the scores with a digest.

        Raises
        ------
        DataError
            If they are damaged.
        """
        path = self.path(digest)
        arrays = read_arrays(path)
        try:
            about = json.loads(arrays["about"].tobytes())
            layout: Layout = build(about["layout"], "layout", self.registry)
            return Said(
                Scores(arrays["values"], layout),
                arrays["labels"],
                arrays["stamps"],
                arrays["positions"],
                arrays.get("groups"),
                about["scale"],
                about["cost"],
                about["seconds"],
                about["settings"],
            )
        except (ValueError, LookupError, TypeError) as error:
            raise DataError(f"{path} holds no scores ({error}): remove it") from error
