"""The built-in integrators."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="integrator",
            name="confidence",
            factory="placecue_integrators.confidence:Confidence",
            summary="Asks for a further cue only where those so far are not sure enough",
            requires=("an integrator",),
        ),
        Component(
            kind="integrator",
            name="gdas",
            factory="placecue_integrators.gdas:GDAS",
            summary="Weighted sum of the scores of all cues (G-DAS)",
            requires=("scores of one layout",),
        ),
        Component(
            kind="integrator",
            name="svm_das",
            factory="placecue_integrators.svm_das:SVMDAS",
            summary="Support vector machine on the scores of all cues (SVM-DAS)",
            requires=("a classifier",),
        ),
        *_rivals(),
    ]


def _rivals() -> list[Component]:
    """Return what G-DAS and SVM-DAS are compared with."""
    probabilities = ("probabilities",)
    return [
        Component(
            kind="integrator",
            name="vote",
            factory="placecue_integrators.vote:Vote",
            summary="Majority vote of the cues' own decisions",
        ),
        Component(
            kind="layout",
            name="votes",
            factory="placecue_integrators.votes:Votes",
            summary="Votes and rank points a class; the most votes win",
        ),
        Component(
            kind="integrator",
            name="mean_probability",
            factory="placecue_integrators.probability_rules:MeanProbability",
            summary="Mean of the cues' probabilities",
            requires=probabilities,
        ),
        Component(
            kind="integrator",
            name="product_probability",
            factory="placecue_integrators.probability_rules:ProductProbability",
            summary="Product of the cues' probabilities",
            requires=probabilities,
        ),
        Component(
            kind="integrator",
            name="max_probability",
            factory="placecue_integrators.probability_rules:MaxProbability",
            summary="Largest of the cues' probabilities",
            requires=probabilities,
        ),
        Component(
            kind="integrator",
            name="stacking",
            factory="placecue_integrators.stacking:Stacking",
            summary="Any classifier on the scores of all cues",
            requires=("a classifier",),
        ),
        Component(
            kind="integrator",
            name="dynamic",
            factory="placecue_integrators.dynamic:Dynamic",
            summary="Product of calibrated probabilities, each cue weighted by how sure it is",
        ),
    ]
