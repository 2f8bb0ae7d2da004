"""The built-in cues."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="cue",
            name="crfh",
            factory="placecue_cues.crfh:CRFH",
            summary="Composed receptive field histogram of the image (Linde & Lindeberg 2004)",
            requires=("image",),
        ),
        Component(
            kind="cue",
            name="laser",
            factory="placecue_cues.laser:LaserGeometry",
            summary="Geometric features of a 2D laser scan (Martinez Mozos et al. 2005)",
            requires=("scan",),
        ),
        Component(
            kind="cue",
            name="sift",
            factory="placecue_cues.sift:SIFT",
            summary="Local descriptors at interest points of the image (Lowe 2004)",
            requires=("image",),
        ),
        Component(
            kind="cue",
            name="dense_sift",
            factory="placecue_cues.dense_sift:DenseSift",
            summary="RootSIFT descriptors of patches on a grid, at several scales",
            requires=("image",),
        ),
        Component(
            kind="cue",
            name="gist",
            factory="placecue_cues.gist:Gist",
            summary="Gabor energies over a coarse grid of the image (Oliva & Torralba 2001)",
            requires=("image",),
        ),
        Component(
            kind="cue",
            name="color_histogram",
            factory="placecue_cues.color_histogram:ColorHistogram",
            summary="Joint L*a*b* histogram of the image's colours",
            requires=("image",),
        ),
        Component(
            kind="cue",
            name="fisher_vector",
            factory="placecue_cues.fisher_vector:FisherVector",
            summary="Fisher vector of local descriptors (Perronnin et al. 2010)",
            requires=("image",),
        ),
        Component(
            kind="cue",
            name="bag_of_words",
            factory="placecue_cues.bag_of_words:BagOfWords",
            summary="Histogram of visual words (Csurka et al. 2004)",
            requires=("image",),
        ),
        Component(
            kind="cue",
            name="lite0",
            factory="placecue_cues.lite:EfficientNetLite",
            summary="What EfficientNet-Lite, trained on ImageNet, makes of the image",
            requires=("image", "placecue[deep]"),
        ),
        Component(
            kind="cue",
            name="onnx",
            factory="placecue_cues.deep:OnnxNetwork",
            summary="An output of any ONNX image network",
            requires=("image", "placecue[deep]"),
        ),
        Component(
            kind="cue",
            name="objects",
            factory="placecue_cues.objects:Objects",
            summary="Scores of the objects that an image classifier knows (Rottmann et al. 2005)",
            requires=("image", "placecue[deep]"),
        ),
        Component(
            kind="cue",
            name="joint",
            factory="placecue_cues.joint:Joint",
            summary="Features of several cues for one classifier (low-level integration)",
            requires=("what its parts require",),
        ),
    ]
