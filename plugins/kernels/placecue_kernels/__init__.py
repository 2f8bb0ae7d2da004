"""The built-in kernels."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


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
            requires=("dense or sparse vectors, or parts of such",),
        ),
        Component(
            kind="kernel",
            name="linear",
            factory="placecue_kernels.linear:Linear",
            summary="Dot product between vectors",
            requires=("dense or sparse vectors, or parts of such",),
        ),
        Component(
            kind="kernel",
            name="hi",
            factory="placecue_kernels.hi:HistogramIntersection",
            summary="Histogram intersection kernel",
            requires=("sparse or dense vectors, or parts of such",),
        ),
        Component(
            kind="kernel",
            name="match",
            factory="placecue_kernels.match:Match",
            summary="Match kernel between sets of local descriptors (Wallraven et al. 2003)",
            requires=("local descriptors",),
        ),
        Component(
            kind="kernel",
            name="sum",
            factory="placecue_kernels.combined:Sum",
            summary="Weighted sum of kernels",
            requires=("what its kernels take",),
        ),
        Component(
            kind="kernel",
            name="product",
            factory="placecue_kernels.combined:Product",
            summary="Product of kernels",
            requires=("what its kernels take",),
        ),
        Component(
            kind="kernel",
            name="parts",
            factory="placecue_kernels.parts:Parts",
            summary="A kernel for each part of a joint cue, in a weighted sum or product",
            requires=("features in parts",),
        ),
        Component(
            kind="kernel",
            name="mkl",
            factory="placecue_kernels.mkl:MKL",
            summary="A kernel for each part of a joint cue, with learned weights (MKL)",
            requires=("features in parts",),
        ),
    ]
