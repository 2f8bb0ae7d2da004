"""A plugin as a third party would write it: one class of every kind, and no option file."""

from __future__ import annotations

from placecue import Component, hookimpl


@hookimpl
def placecue_components() -> list[Component]:
    """Return what this package brings."""
    return [
        Component("cue", "sectors", "everykind.cue:Sectors", "Mean range of sectors", ("scan",)),
        Component("kernel", "laplace", "everykind.kernel:Laplace", "exp(-gamma |a - b|)"),
        Component("classifier", "similar", "everykind.classifier:Similar", "Likest class"),
        Component("integrator", "stacked", "everykind.integrator:Stacked", "Scores, joined"),
        Component("accumulator", "journal", "everykind.journal:Journal", "Areas in order of time"),
        Component("boundary", "metres", "everykind.journal:Metres", "So many metres were driven"),
        Component("source", "boxes", "everykind.source:Boxes", "Four bare rooms"),
        Component("folds", "odd_even", "everykind.folds:OddEven", "Runs of samples in turn"),
        Component("scaling", "median", "everykind.scaling:Median", "By median and deviation"),
        Component("layout", "unlikeness", "everykind.layout:Unlikeness", "The smallest wins"),
        Component("adapter", "acme_beams", "everykind.adapter:AcmeBeams", "acme.Beams as a scan"),
    ]
