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
            name="svm_das",
            factory="placecue_integrators.svm_das:SVMDAS",
            summary="Support vector machine on the scores of all cues (SVM-DAS)",
            requires=("a classifier",),
        ),
    ]
