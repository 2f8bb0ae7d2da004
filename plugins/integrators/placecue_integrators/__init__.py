"""The built-in integrators."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
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
    ]
