"""The built-in kernels."""

from __future__ import annotations

from placecue.discovery.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="kernel",
            name="chi2",
            factory="placecue_kernels.chi2:Chi2",
            summary="Chi-squared kernel between histograms",
            requires=("sparse or dense histograms",),
        ),
        Component(
            kind="kernel",
            name="rbf",
            factory="placecue_kernels.rbf:RBF",
            summary="Gaussian kernel between vectors",
            requires=("dense vectors",),
        ),
        Component(
            kind="kernel",
            name="linear",
            factory="placecue_kernels.linear:Linear",
            summary="Dot product between vectors",
            requires=("dense or sparse vectors",),
        ),
    ]
