"""The built-in classifiers."""

from __future__ import annotations

from placecue.discovery.hooks import Component, hookimpl


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
    ]
