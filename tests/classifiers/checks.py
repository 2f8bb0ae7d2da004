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

#: By a parameter of a classifier and its value, and name of the check.
CANNOT_APPLY_WITH = {
    ("multiclass", "modified_oaa"): {
        "check_class_weight_classifiers": (
            "the class is that whose training mean the output lies nearest, and that mean moves "
            "along with the weight"
        ),
    },
    ("probability", "isotonic"): {
        "check_class_weight_classifiers": (
            "calibration undoes class weights: probabilities are those of the samples as they came"
        ),
    },
}


def cannot_apply(classifier: Any) -> dict[str, str]:
    """Return the checks that cannot apply to a classifier, each with the reason."""
    found = CANNOT_APPLY | CANNOT_APPLY_TO.get(type(classifier).__name__, {})
    for (name, value), checks in CANNOT_APPLY_WITH.items():
        if getattr(classifier, name, None) == value:
            found |= checks
    return found
