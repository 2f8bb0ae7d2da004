"""Cues whose outputs can be added up: all in one layout."""

from __future__ import annotations

from placecue.errors import UsageError
from placecue.evidence import Evidence
from placecue.scores import DecisionList, Layout


def common_layout(evidence: Evidence, integrator: str) -> Layout:
    """Return the one layout that all cues have.

    Parameters
    ----------
    evidence : Evidence
        Of one cue or more.
    integrator : str
        Who wants it, for the message.

    Raises
    ------
    UsageError
        If two cues have different ones; it names both.
    """
    first, *others = evidence.cues
    layout = evidence.layout(first)
    for cue in others:
        other = evidence.layout(cue)
        if other != layout:
            raise UsageError(
                f"{integrator} adds up the outputs of cues, which must be of one layout: those of "
                f"'{first}' are {_in_words(layout)}, those of '{cue}' {_in_words(other)}; give "
                f"both the same classes and multiclass=, or choose integrator=svm_das, which "
                "joins outputs of any layout"
            )
    return layout


def _in_words(layout: Layout) -> str:
    if isinstance(layout, DecisionList):
        return f"{layout.name} in the order {', '.join(layout.order)}"
    return f"{layout.name} of {', '.join(layout.classes)}"
