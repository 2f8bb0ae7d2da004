"""placecue: what kind of place a robot is in, from many cues.

The public names of the package: what a component is written with. They are imported when first
used, so that ``import placecue`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from placecue import estimators
    from placecue.accumulator import Accumulator, AreaUpdate, Boundary
    from placecue.belief import Belief
    from placecue.camera import PinholeCamera
    from placecue.checks import check_choice, check_number, check_whole
    from placecue.classifier import Classifier, FoldFeatures, UnfitSamples, WrongKind, wrong_kind
    from placecue.components.hooks import Component, Kind, hookimpl
    from placecue.cue import Alteration, Cue
    from placecue.depth import Intrinsics, virtual_scan
    from placecue.errors import (
        DataError,
        PlacecueError,
        PluginError,
        UnusableObservation,
        UsageError,
        choices,
    )
    from placecue.estimator import Estimator, clone
    from placecue.estimators import allow_estimators
    from placecue.evidence import Evidence, ObservedEvidence, StoredEvidence
    from placecue.faults import Faults
    from placecue.features import (
        DescriptorSets,
        FeatureBatch,
        FeatureKind,
        Features,
        kind_of,
        stack,
        take,
    )
    from placecue.folds import Blocks, ByLog, FoldScheme, InterleavedChunks, Rows, Shuffled
    from placecue.integrator import Integrator
    from placecue.kernel import DistanceKernel, Gram, Kernel
    from placecue.learning.rejection import Unknown
    from placecue.learning.samples import CueSamples, LearnedFrom
    from placecue.learning.training import train
    from placecue.logs.adapters.base import Adapter, Role
    from placecue.logs.messages.geometry import Transform
    from placecue.logs.messages.images import RawImage
    from placecue.observation import (
        PARTS,
        EncodedImage,
        Image,
        LaserScan,
        Observation,
        Part,
        Pose2D,
    )
    from placecue.pipeline import Pipeline
    from placecue.progress import track
    from placecue.scaling import QuantileScaling, RangeScaling, Scaling, StandardScaling
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
    from placecue.semantic_map import UNKNOWN, Area, Node, SemanticMap
    from placecue.skipped import Skipped
    from placecue.source import Source

__version__ = "0.1.0"

__all__ = [
    "Accumulator",
    "Adapter",
    "Alteration",
    "Area",
    "AreaUpdate",
    "Belief",
    "Blocks",
    "Boundary",
    "ByLog",
    "Classifier",
    "Component",
    "Cue",
    "CueSamples",
    "DataError",
    "Decision",
    "DecisionList",
    "DescriptorSets",
    "DistanceKernel",
    "EncodedImage",
    "Estimator",
    "Evidence",
    "Faults",
    "FeatureBatch",
    "FeatureKind",
    "Features",
    "FoldFeatures",
    "FoldScheme",
    "Gram",
    "Image",
    "Integrator",
    "InterleavedChunks",
    "Intrinsics",
    "Kernel",
    "Kind",
    "LaserScan",
    "Layout",
    "LearnedFrom",
    "ModifiedOneAgainstAll",
    "Node",
    "Observation",
    "ObservedEvidence",
    "OneAgainstAll",
    "OneAgainstOne",
    "PARTS",
    "Part",
    "PinholeCamera",
    "Pipeline",
    "PlacecueError",
    "PluginError",
    "Pose2D",
    "Probabilities",
    "QuantileScaling",
    "RangeScaling",
    "RawImage",
    "Role",
    "Rows",
    "Scaling",
    "Scores",
    "SemanticMap",
    "Shuffled",
    "Skipped",
    "Source",
    "StandardScaling",
    "StoredEvidence",
    "Transform",
    "UNKNOWN",
    "UnfitSamples",
    "Unknown",
    "UnusableObservation",
    "UsageError",
    "WrongKind",
    "__version__",
    "allow_estimators",
    "check_choice",
    "check_number",
    "check_whole",
    "choices",
    "clone",
    "estimators",
    "hookimpl",
    "kind_of",
    "stack",
    "take",
    "track",
    "train",
    "virtual_scan",
    "wrong_kind",
]

#: Where each name is at home.
_MODULES = {
    "accumulator": ("Accumulator", "AreaUpdate", "Boundary"),
    "belief": ("Belief",),
    "camera": ("PinholeCamera",),
    "checks": ("check_choice", "check_number", "check_whole"),
    "classifier": ("Classifier", "FoldFeatures", "UnfitSamples", "WrongKind", "wrong_kind"),
    "components.hooks": ("Component", "Kind", "hookimpl"),
    "cue": ("Alteration", "Cue"),
    "depth": ("Intrinsics", "virtual_scan"),
    "errors": (
        "DataError",
        "PlacecueError",
        "PluginError",
        "UnusableObservation",
        "UsageError",
        "choices",
    ),
    "estimator": ("Estimator", "clone"),
    "estimators": ("allow_estimators",),
    "evidence": ("Evidence", "ObservedEvidence", "StoredEvidence"),
    "faults": ("Faults",),
    "features": (
        "DescriptorSets",
        "FeatureBatch",
        "FeatureKind",
        "Features",
        "kind_of",
        "stack",
        "take",
    ),
    "folds": ("Blocks", "ByLog", "FoldScheme", "InterleavedChunks", "Rows", "Shuffled"),
    "integrator": ("Integrator",),
    "kernel": ("DistanceKernel", "Gram", "Kernel"),
    "learning.rejection": ("Unknown",),
    "learning.samples": ("CueSamples", "LearnedFrom"),
    "learning.training": ("train",),
    "logs.adapters.base": ("Adapter", "Role"),
    "logs.messages.geometry": ("Transform",),
    "logs.messages.images": ("RawImage",),
    "observation": ("PARTS", "EncodedImage", "Image", "LaserScan", "Observation", "Part", "Pose2D"),
    "pipeline": ("Pipeline",),
    "progress": ("track",),
    "scaling": ("QuantileScaling", "RangeScaling", "Scaling", "StandardScaling"),
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
    "semantic_map": ("UNKNOWN", "Area", "Node", "SemanticMap"),
    "skipped": ("Skipped",),
    "source": ("Source",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"placecue.{_HOME[name]}"), name)
    if name in __all__:  # a module
        return import_module(f"placecue.{name}")
    raise AttributeError(f"module 'placecue' has no attribute '{name}'")
