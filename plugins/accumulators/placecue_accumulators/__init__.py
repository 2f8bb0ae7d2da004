"""The built-in accumulators, and the boundaries between areas."""

from __future__ import annotations

from placecue.components.hooks import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return the components of this package."""
    return [
        Component(
            kind="accumulator",
            name="spatiotemporal",
            factory="placecue_accumulators.spatiotemporal:SpatioTemporal",
            summary="Beliefs averaged in bins of space, summed over an area",
            requires=("pose",),
        ),
        Component(
            kind="accumulator",
            name="hmm",
            factory="placecue_accumulators.hmm:HiddenMarkov",
            summary="A hidden Markov model over the places along the drive",
            requires=("pose",),
        ),
        Component(
            kind="accumulator",
            name="crf",
            factory="placecue_accumulators.crf:RandomField",
            summary="A conditional random field over the navigation graph",
            requires=("pose",),
        ),
        Component(
            kind="accumulator",
            name="relaxation",
            factory="placecue_accumulators.relaxation:Relaxation",
            summary="Probabilistic relaxation over the navigation graph",
            requires=("pose",),
        ),
        Component(
            kind="boundary",
            name="door",
            factory="placecue_accumulators.door:Door",
            summary="A doorway that the laser sees on both sides",
            requires=("scan", "pose"),
        ),
        Component(
            kind="boundary",
            name="evidence",
            factory="placecue_accumulators.evidence:ChangedEvidence",
            summary="A change in the stream of beliefs: two places, not one",
            requires=("pose",),
        ),
        Component(
            kind="boundary",
            name="none",
            factory="placecue_accumulators.never:Never",
            summary="None: no area ever ends",
        ),
        Component(
            kind="boundary",
            name="node",
            factory="placecue_accumulators.node:NodeLeft",
            summary="The node of the navigation graph that was left",
            requires=("pose",),
        ),
    ]
