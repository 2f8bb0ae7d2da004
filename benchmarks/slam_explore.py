"""Section 7's experiment: a robot explores a floor and labels areas, by poses of three kinds."""

from __future__ import annotations

from typing import Any

import numpy as np

from placecue import Pipeline, SemanticMap, Source
from placecue.slam.retold import Retold
from placecue.slam.straightened import Straightened
from placecue_accumulators.spatiotemporal import SpatioTemporal
from placecue_classifiers.svm import SVM
from placecue_cues.laser import LaserGeometry
from placecue_kernels.rbf import RBF
from placecue_office.simulator import Office

#: What the wheels err by; areas of fewer nodes are corners of others.
DRIFT, FEWEST = 0.03, 2


def explored(pipeline: Pipeline, seed: int) -> dict[str, Any]:
    """Label an exploration by true poses, by odometry, and by odometry corrected by scans."""
    kinds: dict[str, tuple[Source, bool]] = {
        "truth": (_explores(seed, pose="truth"), False),
        "odometry": (_explores(seed, drift=DRIFT), False),
        "slam": (Straightened(_explores(seed, drift=DRIFT)), True),
    }
    maps = {name: _map(pipeline, *kind) for name, kind in kinds.items()}
    truth = maps.pop("truth")
    areas = [area for area in truth.areas if len(_nodes(truth, area.id)) >= FEWEST]
    return {
        "seed": seed,
        "areas": len(areas),
        **{
            name: {
                "alike": sum(
                    _label_at(made, _nodes(truth, area.id)) == area.label for area in areas
                ),
                "areas": sum(len(_nodes(made, area.id)) >= FEWEST for area in made.areas),
            }
            for name, made in maps.items()
        },
    }


def trained() -> Pipeline:
    """Return a model of the laser alone, trained on another recording of the floor."""
    laser = (LaserGeometry(), SVM(kernel=RBF()))
    return Pipeline(cues={"laser": laser}).fit(Office(seed=0, run=1, pose="truth"))


def _explores(seed: int, **options: Any) -> Office:
    return Office(seed=0, run=2 + seed, route="explore", **options)


def _map(pipeline: Pipeline, source: Source, corrected: bool) -> SemanticMap:
    accumulator = Retold(SpatioTemporal()) if corrected else SpatioTemporal()
    for _ in pipeline.label(source, accumulator, batch=16):
        pass
    return accumulator.semantic_map()


def _nodes(made: SemanticMap, area: int) -> np.ndarray:
    return np.array([(n.x, n.y) for n in made.nodes if n.area == area and not n.gateway])


def _label_at(made: SemanticMap, places: np.ndarray) -> str | None:
    """Return the label that a map has at most of some places, by its nearest nodes."""
    nodes = [node for node in made.nodes if not node.gateway]
    positions = np.array([(node.x, node.y) for node in nodes])
    labels = {area.id: area.label for area in made.areas}
    told = [labels[nodes[int(np.hypot(*(positions - at).T).argmin())].area] for at in places]
    return max(set(told), key=told.count) if told else None
