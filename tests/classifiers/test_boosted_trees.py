"""Boosted trees say what scikit-learn's say, and hold nothing but arrays."""

from pathlib import Path

import numpy as np
import pytest
from sklearn.datasets import make_classification
from sklearn.ensemble import HistGradientBoostingClassifier

from placecue import DataError, Pipeline, UsageError
from placecue.components.build import build
from placecue.components.manager import load_plugins
from placecue.storage.model import load_model, save_model
from placecue_classifiers.boosted_trees import BoostedTrees
from placecue_cues.laser import LaserGeometry

REGISTRY = load_plugins(built_ins_only=True).registry
NAMES = np.array(["corridor", "kitchen", "lab", "office", "printer"])


def samples(classes: int, n: int = 300) -> tuple[np.ndarray, np.ndarray]:
    features, codes = make_classification(
        n, 12, n_informative=6, n_classes=classes, class_sep=1.5, random_state=1
    )
    # Single precision, in which thresholds are kept.
    return features.astype(np.float32).astype(np.float64), NAMES[codes]


@pytest.mark.parametrize("classes", [2, 5])
def test_probabilities_are_those_of_scikit_learn(classes: int) -> None:
    features, labels = samples(classes)
    ours = BoostedTrees(rounds=20, leaves=6, learning_rate=0.2, l2=0.5).fit(features, labels)
    theirs = HistGradientBoostingClassifier(
        max_iter=20,
        max_leaf_nodes=6,
        learning_rate=0.2,
        l2_regularization=0.5,
        class_weight="balanced",
        early_stopping=False,
        random_state=0,
    ).fit(features, labels)
    scores = ours.scores(features)
    assert scores.layout.classes == tuple(theirs.classes_)
    close = np.isclose(scores.values, theirs.predict_proba(features), atol=1e-5).all(axis=1)
    # A sample at a threshold may fall to the other side of it in single precision.
    assert close.mean() > 0.98
    assert (ours.predict(features) == labels).mean() > 0.9


def test_two_features_together() -> None:
    """Classes of the four quadrants in a chequer, which no sum over single features tells."""
    rng = np.random.default_rng(0)
    features = rng.uniform(-1, 1, (800, 2))
    labels = np.where(features[:, 0] * features[:, 1] > 0, "office", "corridor")
    trees = BoostedTrees(rounds=60, leaves=4).fit(features[:400], labels[:400])
    assert (trees.predict(features[400:]) == labels[400:]).mean() > 0.9


def fitted_pipeline() -> Pipeline:
    features, labels = samples(4)
    pipeline = Pipeline({"laser": (LaserGeometry(), BoostedTrees(rounds=5))})
    pipeline.cues["laser"].classifier.fit(features, labels)
    return pipeline


def test_saved_and_loaded(tmp_path: Path) -> None:
    pipeline = fitted_pipeline()
    save_model(pipeline, tmp_path, REGISTRY)
    again = load_model(tmp_path, REGISTRY).cues["laser"].classifier
    features, _ = samples(4)
    before = pipeline.cues["laser"].classifier.scores(features)
    np.testing.assert_array_equal(again.scores(features).values, before.values)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("left_", lambda old: np.zeros_like(old)),
        ("right_", lambda old: old + len(old)),
        ("features_", lambda old: np.where(old >= 0, 12, old)),
        ("thresholds_", lambda old: old[:-1]),
        ("trees_", lambda old: old[:, :-1]),
        ("trees_", lambda old: old - 1),
        ("baseline_", lambda old: old[:-1]),
    ],
)
def test_what_cannot_be(tmp_path: Path, name: str, change) -> None:  # type: ignore[no-untyped-def]
    pipeline = fitted_pipeline()
    classifier = pipeline.cues["laser"].classifier
    setattr(classifier, name, change(getattr(classifier, name)).astype(np.int32))
    save_model(pipeline, tmp_path, REGISTRY)
    with pytest.raises(DataError, match="damaged"):
        load_model(tmp_path, REGISTRY)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [({"rounds": 0}, "rounds"), ({"leaves": 1}, "leaves"), ({"class_weight": "big"}, "balanced")],
)
def test_wrong_parameters(parameters: dict[str, object], said: str) -> None:
    features, labels = samples(4)
    with pytest.raises(UsageError, match=said):
        BoostedTrees(**parameters).fit(features, labels)  # type: ignore[arg-type]


def test_built_by_its_name() -> None:
    assert isinstance(build("boosted_trees", "classifier", REGISTRY), BoostedTrees)
