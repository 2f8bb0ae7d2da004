"""placecue: what kind of place a robot is in, from many cues.

The public names of the package: what a component is written with. They are imported when first
used, so that ``import placecue`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from placecue import contracts, estimators
    from placecue.accumulator import Accumulator, AreaUpdate, Boundary
    from placecue.agreement import agreeing, log_odds_lost
    from placecue.belief import Belief
    from placecue.camera import PinholeCamera
    from placecue.checks import check_choice, check_flag, check_number, check_whole
    from placecue.classifier import Classifier, UnfitSamples, WrongKind, wrong_kind
    from placecue.components.hooks import Component, Kind, hookimpl
    from placecue.cue import Augmentation, Cue
    from placecue.cue_model import CueModel
    from placecue.decoding import decoded
    from placecue.depth import Intrinsics, virtual_scan
    from placecue.distribution import doubted, log_odds, softmax, tempered
    from placecue.errors import (
        DataError,
        PlacecueError,
        PluginError,
        UnusableObservation,
        UsageError,
        choices,
        described,
    )
    from placecue.estimator import Estimator, clone
    from placecue.estimators import allow_estimators
    from placecue.evidence import Evidence, ObservedEvidence, StoredEvidence, concatenate
    from placecue.extraction import Extracted, Extraction
    from placecue.faults import Faults
    from placecue.features import (
        DescriptorSets,
        Families,
        FeatureBatch,
        FeatureKind,
        FeatureParts,
        Features,
        kind_of,
        n_samples,
        stack,
        take,
    )
    from placecue.folds import Blocks, ByLog, FoldScheme, InterleavedChunks, Rows, Shuffled
    from placecue.grams import Grams, KeptGrams, Known, current, keeping
    from placecue.guard import call, step
    from placecue.held_out import HeldOut
    from placecue.integrator import Integrator
    from placecue.interrupting import interruptible
    from placecue.kernel import DistanceKernel, Gram, Kernel, fit_kernel
    from placecue.labels.geojson import Feature, FeatureCollection, read_geojson
    from placecue.learning.rejection import Unknown
    from placecue.limits import Limits, current_limits
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
    from placecue.ownership import provenance
    from placecue.pipeline import Pipeline
    from placecue.progress import track
    from placecue.recognition import Found
    from placecue.scaling import (
        FamilyScaling,
        QuantileScaling,
        RangeScaling,
        Scaling,
        StandardScaling,
        UnitLength,
        UnitSpread,
        unit_length,
    )
    from placecue.scene_folds import Scenes
    from placecue.schemes import Schemes, sets_of
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
    from placecue.source import Source
    from placecue.training_set import TrainingSet
    from placecue.user_folders import cache_folder

__version__ = "0.1.0"

__all__ = [
    "Accumulator",
    "Adapter",
    "Area",
    "AreaUpdate",
    "Augmentation",
    "Belief",
    "Blocks",
    "Boundary",
    "ByLog",
    "Classifier",
    "Component",
    "Cue",
    "CueModel",
    "DataError",
    "Decision",
    "DecisionList",
    "DescriptorSets",
    "DistanceKernel",
    "EncodedImage",
    "Estimator",
    "Evidence",
    "Extracted",
    "Extraction",
    "Families",
    "FamilyScaling",
    "Faults",
    "Feature",
    "FeatureBatch",
    "FeatureCollection",
    "FeatureKind",
    "FeatureParts",
    "Features",
    "FoldScheme",
    "Found",
    "Gram",
    "Grams",
    "HeldOut",
    "Image",
    "Integrator",
    "InterleavedChunks",
    "Intrinsics",
    "KeptGrams",
    "Kernel",
    "Kind",
    "Known",
    "LaserScan",
    "Layout",
    "Limits",
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
    "Scenes",
    "Schemes",
    "Scores",
    "SemanticMap",
    "Shuffled",
    "Source",
    "StandardScaling",
    "StoredEvidence",
    "TrainingSet",
    "Transform",
    "UNKNOWN",
    "UnfitSamples",
    "UnitLength",
    "UnitSpread",
    "Unknown",
    "UnusableObservation",
    "UsageError",
    "WrongKind",
    "__version__",
    "agreeing",
    "allow_estimators",
    "cache_folder",
    "call",
    "check_choice",
    "check_flag",
    "check_number",
    "check_whole",
    "choices",
    "clone",
    "concatenate",
    "contracts",
    "current",
    "current_limits",
    "decoded",
    "described",
    "doubted",
    "estimators",
    "fit_kernel",
    "hookimpl",
    "interruptible",
    "keeping",
    "kind_of",
    "log_odds",
    "log_odds_lost",
    "n_samples",
    "provenance",
    "read_geojson",
    "sets_of",
    "softmax",
    "stack",
    "step",
    "take",
    "tempered",
    "track",
    "unit_length",
    "virtual_scan",
    "wrong_kind",
]

#: Where each name is at home.
_MODULES = {
    "accumulator": ("Accumulator", "AreaUpdate", "Boundary"),
    "belief": ("Belief",),
    "camera": ("PinholeCamera",),
    "checks": ("check_choice", "check_flag", "check_number", "check_whole"),
    "classifier": ("Classifier", "UnfitSamples", "WrongKind", "wrong_kind"),
    "components.hooks": ("Component", "Kind", "hookimpl"),
    "cue": ("Augmentation", "Cue"),
    "cue_model": ("CueModel",),
    "decoding": ("decoded",),
    "depth": ("Intrinsics", "virtual_scan"),
    "errors": (
        "DataError",
        "PlacecueError",
        "PluginError",
        "UnusableObservation",
        "UsageError",
        "choices",
        "described",
    ),
    "agreement": ("agreeing", "log_odds_lost"),
    "distribution": ("doubted", "log_odds", "softmax", "tempered"),
    "estimator": ("Estimator", "clone"),
    "estimators": ("allow_estimators",),
    "evidence": ("Evidence", "ObservedEvidence", "StoredEvidence", "concatenate"),
    "extraction": ("Extracted", "Extraction"),
    "faults": ("Faults",),
    "features": (
        "DescriptorSets",
        "Families",
        "FeatureBatch",
        "FeatureKind",
        "FeatureParts",
        "Features",
        "kind_of",
        "n_samples",
        "stack",
        "take",
    ),
    "folds": ("Blocks", "ByLog", "FoldScheme", "InterleavedChunks", "Rows", "Shuffled"),
    "grams": ("Grams", "KeptGrams", "Known", "current", "keeping"),
    "guard": ("call", "step"),
    "held_out": ("HeldOut",),
    "integrator": ("Integrator",),
    "interrupting": ("interruptible",),
    "kernel": ("DistanceKernel", "Gram", "Kernel", "fit_kernel"),
    "labels.geojson": ("Feature", "FeatureCollection", "read_geojson"),
    "learning.rejection": ("Unknown",),
    "limits": ("Limits", "current_limits"),
    "logs.adapters.base": ("Adapter", "Role"),
    "logs.messages.geometry": ("Transform",),
    "logs.messages.images": ("RawImage",),
    "observation": ("PARTS", "EncodedImage", "Image", "LaserScan", "Observation", "Part", "Pose2D"),
    "pipeline": ("Pipeline",),
    "progress": ("track",),
    "ownership": ("provenance",),
    "recognition": ("Found",),
    "scaling": (
        "FamilyScaling",
        "QuantileScaling",
        "RangeScaling",
        "Scaling",
        "StandardScaling",
        "UnitLength",
        "UnitSpread",
        "unit_length",
    ),
    "schemes": ("Schemes", "sets_of"),
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
    "scene_folds": ("Scenes",),
    "semantic_map": ("UNKNOWN", "Area", "Node", "SemanticMap"),
    "source": ("Source",),
    "training_set": ("TrainingSet",),
    "user_folders": ("cache_folder",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"placecue.{_HOME[name]}"), name)
    if name in __all__:  # a module
        return import_module(f"placecue.{name}")
    raise AttributeError(f"module 'placecue' has no attribute '{name}'")
