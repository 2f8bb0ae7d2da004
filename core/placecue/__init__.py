"""placecue: what kind of place a robot is in, from many cues.

The public names of the package. They are imported when first used, so that ``import placecue``
costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from placecue.accumulator import Accumulator, AreaUpdate, Boundary
    from placecue.belief import Belief
    from placecue.camera import PinholeCamera
    from placecue.classifier import Classifier
    from placecue.components.hooks import Component, hookimpl
    from placecue.cue import Cue
    from placecue.errors import (
        DataError,
        PlacecueError,
        PluginError,
        UnusableObservation,
        UsageError,
    )
    from placecue.estimators import allow_estimators
    from placecue.evidence import Evidence, ObservedEvidence, StoredEvidence
    from placecue.features import DescriptorSets, FeatureBatch, FeatureKind, Features
    from placecue.folds import Blocks, ByLog, FoldScheme, InterleavedChunks, Shuffled
    from placecue.integrator import Integrator
    from placecue.kernel import DistanceKernel, Kernel
    from placecue.learning.rejection import Unknown
    from placecue.observation import EncodedImage, LaserScan, Observation, Pose2D
    from placecue.pipeline import Pipeline
    from placecue.scores import (
        Decision,
        DecisionList,
        Layout,
        ModifiedOneAgainstAll,
        OneAgainstAll,
        OneAgainstOne,
        Probabilities,
        Scores,
    )
    from placecue.semantic_map import Area, Node, SemanticMap
    from placecue.source import Source

__version__ = "0.1.0"

_MODULES = {
    "accumulator": ("Accumulator", "AreaUpdate", "Boundary"),
    "belief": ("Belief",),
    "camera": ("PinholeCamera",),
    "classifier": ("Classifier",),
    "cue": ("Cue",),
    "components.hooks": ("Component", "hookimpl"),
    "errors": ("DataError", "PlacecueError", "PluginError", "UnusableObservation", "UsageError"),
    "evidence": ("Evidence", "ObservedEvidence", "StoredEvidence"),
    "features": ("DescriptorSets", "FeatureBatch", "FeatureKind", "Features"),
    "folds": ("Blocks", "ByLog", "FoldScheme", "InterleavedChunks", "Shuffled"),
    "estimators": ("allow_estimators",),
    "integrator": ("Integrator",),
    "kernel": ("DistanceKernel", "Kernel"),
    "observation": ("EncodedImage", "LaserScan", "Observation", "Pose2D"),
    "pipeline": ("Pipeline",),
    "learning.rejection": ("Unknown",),
    "scores": (
        "Decision",
        "DecisionList",
        "Layout",
        "ModifiedOneAgainstAll",
        "OneAgainstAll",
        "OneAgainstOne",
        "Probabilities",
        "Scores",
    ),
    "semantic_map": ("Area", "Node", "SemanticMap"),
    "source": ("Source",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [*sorted(_HOME), "__version__"]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"placecue.{_HOME[name]}"), name)
    raise AttributeError(f"module 'placecue' has no attribute '{name}'")
