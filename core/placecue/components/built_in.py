"""The fold schemes, scalings and layouts that placecue brings, by the door of all plugins."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [*_folds(), *_scalings(), *_layouts()]


def _folds() -> list[Component]:
    return [
        Component(
            kind="folds",
            name="interleaved",
            factory="placecue.folds:InterleavedChunks",
            summary="Chunks of a few seconds, dealt to the folds in turn",
        ),
        Component(
            kind="folds",
            name="blocks",
            factory="placecue.folds:Blocks",
            summary="Contiguous fractions of each class",
        ),
        Component(
            kind="folds",
            name="shuffled",
            factory="placecue.folds:Shuffled",
            summary="Samples dealt to the folds at random",
        ),
        Component(
            kind="folds",
            name="by_log",
            factory="placecue.folds:ByLog",
            summary="Whole logs: train on the others, test on one",
            requires=("two logs or more",),
        ),
        Component(
            kind="folds",
            name="scenes",
            factory="placecue.scene_folds:Scenes",
            summary="Whole scenes, balanced over classes",
            requires=("a source that tells scenes, or two logs or more",),
        ),
    ]


def _scalings() -> list[Component]:
    return [
        Component(
            kind="scaling",
            name="range",
            factory="placecue.scaling:RangeScaling",
            summary="To [-1, 1] by the training minimum and maximum",
            requires=("dense vectors",),
        ),
        Component(
            kind="scaling",
            name="standard",
            factory="placecue.scaling:StandardScaling",
            summary="To zero mean and unit variance",
            requires=("dense vectors",),
        ),
        Component(
            kind="scaling",
            name="quantiles",
            factory="placecue.scaling:QuantileScaling",
            summary="To the training quantiles, in [-1, 1]",
            requires=("dense vectors",),
        ),
        Component(
            kind="scaling",
            name="unit",
            factory="placecue.scaling:UnitLength",
            summary="Every sample to unit length, after another scaling",
            requires=("dense vectors",),
        ),
        Component(
            kind="scaling",
            name="families",
            factory="placecue.scaling:FamilyScaling",
            summary="Every family of features the same weight, after another scaling",
            requires=("dense vectors",),
        ),
        Component(
            kind="scaling",
            name="even",
            factory="placecue.scaling:UnitSpread",
            summary="Variances that sum to one, after another scaling: joined parts have one say",
            requires=("dense vectors", "sparse histograms"),
        ),
    ]


def _layouts() -> list[Component]:
    return [
        Component(
            kind="layout",
            name="one_against_one",
            factory="placecue.scores:OneAgainstOne",
            summary="A score a pair of classes; majority vote",
        ),
        Component(
            kind="layout",
            name="one_against_all",
            factory="placecue.scores:OneAgainstAll",
            summary="A score a class; the largest wins",
        ),
        Component(
            kind="layout",
            name="modified_one_against_all",
            factory="placecue.scores:ModifiedOneAgainstAll",
            summary="A score a class; the one nearest to its training mean wins",
        ),
        Component(
            kind="layout",
            name="probabilities",
            factory="placecue.scores:Probabilities",
            summary="A probability a class; the largest wins",
        ),
        Component(
            kind="layout",
            name="decision_list",
            factory="placecue.scores:DecisionList",
            summary="A score a class; the first positive one of the list wins",
        ),
    ]
