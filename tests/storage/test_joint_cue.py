"""A joint cue in model folders and in the feature cache: the same to the last bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from caching import CALLS, Counting, Learning, extracted, same, shards
from placecue import Component, FeatureParts, Pipeline, PluginError
from placecue.scaling import QuantileScaling
from placecue.storage.feature_cache import FeatureCache
from placecue.storage.model import load_model, read_manifest, save_model
from placecue_classifiers.svm import SVM
from placecue_cues.joint import Joint
from placecue_kernels.linear import Linear
from placecue_kernels.mkl import MKL
from placecue_kernels.parts import Parts
from toys import Beams, Brightness, Walk, registry

WALK = Walk(rounds=1)
KINDS = ("dense", "sparse", "descriptors")


def counting(factor: float = 1.0) -> Joint:
    return Joint({kind: Counting(kind, factor) for kind in KINDS})


def test_features_in_parts_are_kept_as_they_were(tmp_path: Path) -> None:
    fresh = extracted(None, counting(), WALK)
    assert isinstance(fresh, FeatureParts)
    first = extracted(tmp_path, counting(), WALK)
    CALLS.clear()
    kept = extracted(tmp_path, counting(), WALK)
    assert CALLS["extract"] == 0
    assert same(kept, fresh)
    assert same(first, fresh)
    [*_, damaged] = shards(tmp_path)
    damaged.write_bytes(damaged.read_bytes()[:-100])
    assert same(extracted(tmp_path, counting(), WALK), fresh)
    assert CALLS["extract"] > 0


def test_another_part_or_parameter_or_version_is_another_cue(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    extracted(tmp_path, counting(), WALK)
    others = [
        counting(2.0),
        Joint({"dense": Counting("dense"), "sparse": Counting("sparse")}),
        Joint({f"my {kind}": Counting(kind) for kind in KINDS}),
    ]
    for number, other in enumerate(others):
        CALLS.clear()
        extracted(tmp_path, other, WALK)
        assert CALLS["extract"] > 0, number
    monkeypatch.setattr(Counting, "version", "2")
    CALLS.clear()
    extracted(tmp_path, counting(), WALK)
    assert CALLS["extract"] > 0


def test_what_a_part_keeps_for_itself_makes_no_other_cue(tmp_path: Path) -> None:
    cue = counting()
    extracted(tmp_path, cue, WALK)
    assert cue.parts is not None
    cue.parts["dense"]._table = np.arange(3)  # type: ignore[attr-defined]
    CALLS.clear()
    extracted(tmp_path, cue, WALK)
    assert CALLS["extract"] == 0


def test_a_part_that_has_learned_is_kept(tmp_path: Path) -> None:
    known = registry()
    known.add([Component("cue", "learning", "caching:Learning")], "toys", "1.0")

    def trained() -> Pipeline:
        cue = Joint({"beams": Beams(), "bright": Learning()})
        pipeline = Pipeline({"joint": (cue, SVM(Linear(), scaling=QuantileScaling()))})
        with FeatureCache(tmp_path, known) as pipeline.extraction:
            return pipeline.fit(Walk(rounds=2))

    CALLS.clear()
    first = trained()
    assert CALLS["fit"] == 1
    CALLS.clear()
    second = trained()
    assert sum(CALLS.values()) == 0
    scores = [
        np.array([belief.scores.values for belief in each.beliefs(WALK)])
        for each in (first, second)
    ]
    assert scores[0].tobytes() == scores[1].tobytes()


@pytest.mark.parametrize("kernel", [MKL(), MKL(method="easymkl"), Parts(join="product"), Linear()])
def test_a_model_predicts_the_same_to_the_last_bit(tmp_path: Path, kernel: Linear | Parts) -> None:
    cue = Joint({"beams": Beams(), "bright": Brightness()})
    svm = SVM(kernel, scaling=QuantileScaling(11), search={"C": [1.0, 10.0]})
    trained = Pipeline({"joint": (cue, svm)}).fit(Walk(rounds=2))
    loaded = load_model(save_model(trained, tmp_path, registry()), registry())
    for before, after in zip(trained.beliefs(WALK), loaded.beliefs(WALK), strict=True):
        assert before.scores.values.tobytes() == after.scores.values.tobytes()
        assert before.label == after.label
    names = {(each["kind"], each["name"]) for each in read_manifest(tmp_path)["plugins"]}
    assert {("cue", "joint"), ("cue", "beams"), ("cue", "brightness")} <= names


def test_a_part_of_another_version_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    svm = SVM(Linear(), scaling=QuantileScaling())
    trained = Pipeline({"joint": (Joint({"beams": Beams()}), svm)}).fit(WALK)
    save_model(trained, tmp_path, registry())
    monkeypatch.setattr(Beams, "version", "2")
    with pytest.raises(PluginError, match="made with cue 'beams' of version 1"):
        load_model(tmp_path, registry())
