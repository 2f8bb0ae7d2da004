"""SVM-DAS: a support vector machine on the outputs of all cues."""

from __future__ import annotations

from typing import ClassVar

from placecue.scaling import RangeScaling, Scaling
from placecue_integrators.joined_scores import JoinedScores


class SVMDAS(JoinedScores):
    """Discriminative accumulation by a support vector machine.

    The outputs of all cues, each scaled to [-1, 1] by its range on the fitting data, are joined
    into one vector, and a classifier learns to decide on it. Cues may have outputs of any layout.

    Parameters
    ----------
    classifier : Classifier
        Decides on the joined outputs; in the paper a one-against-one SVM with a linear, RBF or
        histogram-intersection kernel.

    Attributes
    ----------
    cues_ : list of str
        The cues, in the order in which their outputs are joined.
    scaling_ : RangeScaling
        Range of each output on the fitting data.
    classifier_ : Classifier
        The fitted classifier.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 4.2.
    """

    scaled_by: ClassVar[type[Scaling] | None] = RangeScaling
    needs: ClassVar[str] = "svm_das needs a classifier, such as classifier={plugin: svm}"
