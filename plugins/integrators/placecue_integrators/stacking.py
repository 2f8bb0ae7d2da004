"""Stacking: any classifier on the outputs of all cues."""

from __future__ import annotations

from typing import ClassVar

from placecue_integrators.joined_scores import JoinedScores


class Stacking(JoinedScores):
    """Stacked generalisation: a classifier learns to decide on the joined outputs of all cues.

    It sees them as they are: what scaling it needs it brings itself. It is SVM-DAS without the
    scaling to the range of the outputs. Cues may have outputs of any layout.

    Parameters
    ----------
    classifier : Classifier
        Decides on the joined outputs, such as any of scikit-learn.

    Attributes
    ----------
    cues_ : list of str
        The cues, in the order in which their outputs are joined.
    scaling_ : None
        The outputs are not scaled.
    classifier_ : Classifier
        The fitted classifier.

    References
    ----------
    Wolpert, Stacked generalization, Neural Networks 5, 1992.
    """

    needs: ClassVar[str] = "stacking needs a classifier, such as classifier={plugin: sklearn}"
