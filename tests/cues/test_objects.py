"""Cue ``objects`` with classifier ``knowledge``: places without any training, and as a model."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.special import softmax

from networks import tiny
from pictures import observe
from placecue import DataError, Observation, Pipeline, UsageError
from placecue.components.manager import load_plugins
from placecue.storage.model import load_model, save_model
from placecue_classifiers.knowledge import Knowledge
from placecue_cues.deep import OnnxNetwork
from placecue_cues.gist import Gist
from placecue_cues.objects import Objects

#: A network's scores of two objects are (r, g - 2 b + 10) of the mean colour; see networks.py.
RED = np.full((2, 2, 3), [30, 0, 0], np.uint8)
GREEN = np.full((2, 2, 3), [0, 8, 0], np.uint8)


@pytest.fixture
def network(tmp_path: Path) -> OnnxNetwork:
    return OnnxNetwork(str(tiny(tmp_path / "tiny.onnx")), output="mean", mean=0, std=1)


@pytest.fixture
def knowledge(tmp_path: Path) -> Knowledge:
    (tmp_path / "objects.txt").write_text("stove\nbed\n")
    (tmp_path / "table.yaml").write_text("kitchen: [stove]\nbedroom: [bed]\n")
    return Knowledge(str(tmp_path / "table.yaml"), objects=str(tmp_path / "objects.txt"))


def test_scores_are_told_from_their_mean(network: OnnxNetwork) -> None:
    # (30, 10) and (0, 18), whose means are 20 and 9.
    found = Objects(network).transform([observe(RED), observe(GREEN)])
    np.testing.assert_allclose(found, [[10, -10], [-9, 9]], atol=1e-5)


def test_of_probabilities_the_logarithm_is_taken(network: OnnxNetwork) -> None:
    network.normalise = "softmax"
    # Logarithms of a softmax differ as the scores do.
    found = Objects(network, scores="probabilities").features(observe(RED))
    np.testing.assert_allclose(found, [10, -10], atol=1e-5)


def test_a_pipeline_that_was_never_trained(network: OnnxNetwork, knowledge: Knowledge) -> None:
    pipeline = Pipeline({"objects": (Objects(network), knowledge.untrained())})
    seen = [Observation(0, image=RED), Observation(1, image=GREEN)]
    beliefs = list(pipeline.beliefs(seen))
    assert [belief.label for belief in beliefs] == ["kitchen", "bedroom"]
    np.testing.assert_allclose(beliefs[1].scores.values, [softmax([9, -9])], atol=1e-5)


def test_a_model_needs_neither_the_table_nor_the_names(
    network: OnnxNetwork, knowledge: Knowledge, tmp_path: Path
) -> None:
    registry = load_plugins(built_ins_only=True).registry
    generator = np.random.default_rng(0)
    seen = []
    for number in range(40):
        base, label = ((RED, "kitchen"), (GREEN, "bedroom"))[number % 2]
        image = np.clip(base + generator.integers(0, 40, (2, 2, 3)), 0, 255).astype(np.uint8)
        seen.append(Observation(number * 10**9, image=image, label=label))
    pipeline = Pipeline({"objects": (Objects(network), knowledge)}).fit(seen)
    folder = save_model(pipeline, tmp_path / "model", registry)
    for name in ("objects.txt", "table.yaml"):
        (tmp_path / name).unlink()
    loaded = load_model(folder, registry)
    for before, after in zip(pipeline.beliefs(seen), loaded.beliefs(seen), strict=True):
        assert before.scores.values.tobytes() == after.scores.values.tobytes()
    tiny(tmp_path / "tiny.onnx", bias=1.0)
    with pytest.raises(DataError, match="another network"):
        list(load_model(folder, registry).beliefs(seen))


def test_it_takes_a_network_and_nothing_else() -> None:
    with pytest.raises(UsageError, match=r"objects\.network must be an image classifier"):
        Objects(Gist()).features(observe(RED))
    with pytest.raises(UsageError, match="scores is 'odds'"):
        Objects(scores="odds").features(observe(RED))
