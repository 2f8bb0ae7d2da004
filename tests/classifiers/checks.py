"""scikit-learn's own checks of estimators: those that cannot apply to placecue's classifiers."""

from __future__ import annotations

from typing import Any

#: By name of the check, for every classifier.
CANNOT_APPLY = {
    "check_fit_score_takes_y": (
        "looks for a parameter named y or Y; placecue's interface calls it labels"
    ),
}

#: By classifier, and name of the check.
CANNOT_APPLY_TO = {
    "AdaBoost": {
        "check_class_weight_classifiers": (
            "the best of all thresholds cuts off the end of a feature where only light samples "
            "lie, which is never wrong; of trees the check itself forbids such leaves"
        ),
    },
}


def cannot_apply(classifier: Any) -> dict[str, str]:
    """Return the checks that cannot apply to a classifier, each with the reason."""
    return CANNOT_APPLY | CANNOT_APPLY_TO.get(type(classifier).__name__, {})
