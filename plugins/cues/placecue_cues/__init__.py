"""The built-in cues."""

from __future__ import annotations

from placecue.discovery.hooks import Component, hookimpl


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
    ]
