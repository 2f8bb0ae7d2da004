"""The built-in classifiers."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="classifier",
            name="svm",
            factory="placecue_classifiers.svm:SVM",
            summary="Support vector machine, one-against-one or one-against-all",
            requires=("a kernel",),
        ),
        Component(
            kind="classifier",
            name="adaboost",
            factory="placecue_classifiers.adaboost:AdaBoost",
            summary="AdaBoost of decision stumps on single features, joined by a decision list",
            requires=("dense vectors",),
        ),
        Component(
            kind="classifier",
            name="nearest_mean",
            factory="placecue_classifiers.nearest_mean:NearestMean",
            summary="Nearest class mean on features of unit length; goes on learning exactly",
            requires=("dense vectors",),
        ),
        Component(
            kind="classifier",
            name="knowledge",
            factory="placecue_classifiers.knowledge:Knowledge",
            summary="Places from objects, by a table of which stand where; needs no training",
            requires=("scores of objects",),
        ),
        Component(
            kind="classifier",
            name="sklearn",
            factory="placecue_classifiers.scikit_learn:ScikitLearn",
            summary="Any classifier of scikit-learn, by its dotted name",
            requires=("dense or sparse vectors",),
        ),
        Component(
            kind="classifier",
            name="grid_search",
            factory="placecue_classifiers.grid_search:GridSearch",
            summary="Any classifier, with parameters picked by cross-validation",
            requires=("a classifier",),
        ),
        Component(
            kind="classifier",
            name="boosted_trees",
            factory="placecue_classifiers.boosted_trees:BoostedTrees",
            summary="Gradient-boosted decision trees, small and fast",
            requires=("dense vectors",),
        ),
    ]
