"""Cue ``onnx``: a network whose numbers are worked out by hand, and what can be wrong with one."""

from __future__ import annotations

import builtins
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from networks import of_bytes, of_one_node, tiny, with_weights_elsewhere
from pictures import in_every_form, observe
from placecue import DataError, Observation, PlacecueError, UnusableObservation, UsageError, clone
from placecue.components.manager import load_plugins
from placecue.observation import Origin, Recording
from placecue.storage.feature_cache import FeatureCache
from placecue_cues.deep import OnnxNetwork

#: Two by two pixels. Their means are (5.5, 6, 7); the network makes (r, g - 2 b + 10) of each.
PIXELS = np.array([[[1, 2, 3], [4, 8, 6]], [[7, 4, 9], [10, 10, 10]]], np.uint8)
PLAIN: dict[str, Any] = {"mean": 0, "std": 1}


@pytest.fixture
def network(tmp_path: Path) -> Path:
    return tiny(tmp_path / "tiny.onnx")


def test_values_are_those_worked_out_by_hand(network: Path) -> None:
    made = OnnxNetwork(str(network), output="mean", **PLAIN).features(observe(PIXELS))
    np.testing.assert_allclose(made, [5.5, 6 - 2 * 7 + 10], atol=1e-6)
    maps = OnnxNetwork(str(network), output="map", pool="none", **PLAIN)
    # r of the four pixels, then g - 2 b + 10: 2 - 6 + 10, 8 - 12 + 10, 4 - 18 + 10, 10 - 20 + 10.
    np.testing.assert_allclose(maps.features(observe(PIXELS)), [1, 4, 7, 10, 6, 6, -4, 0])
    largest = OnnxNetwork(str(network), output="map", pool="max", **PLAIN)
    np.testing.assert_allclose(largest.features(observe(PIXELS)), [10, 6])


def test_pixels_are_normalised_by_channel_and_order(network: Path) -> None:
    scaled = OnnxNetwork(str(network), output="mean", mean=[1.5, 2, 3], std=[2, 4, 1])
    # ((5.5 - 1.5) / 2, (6 - 2) / 4 - 2 (7 - 3) / 1 + 10)
    np.testing.assert_allclose(scaled.features(observe(PIXELS)), [2, 1 - 8 + 10], atol=1e-6)
    turned = OnnxNetwork(str(network), output="mean", colors="bgr", **PLAIN)
    np.testing.assert_allclose(turned.features(observe(PIXELS)), [7, 6 - 2 * 5.5 + 10], atol=1e-6)


def test_outputs_are_made_a_unit_vector_or_probabilities(network: Path) -> None:
    unit = OnnxNetwork(str(network), output="mean", normalise="unit", **PLAIN)
    length = np.hypot(5.5, 2)
    np.testing.assert_allclose(unit.features(observe(PIXELS)), [5.5 / length, 2 / length])
    soft = OnnxNetwork(str(network), output="mean", normalise="softmax", **PLAIN)
    first = 1 / (1 + np.exp(2 - 5.5))
    np.testing.assert_allclose(soft.features(observe(PIXELS)), [first, 1 - first], atol=1e-7)


def test_an_image_is_stretched_cropped_or_padded(network: Path) -> None:
    wide = np.concatenate([np.full((2, 1, 3), 200, np.uint8), PIXELS], axis=1)
    wide = np.concatenate([wide, np.full((2, 1, 3), 200, np.uint8)], axis=1)
    cropped = OnnxNetwork(str(network), output="mean", framing="crop", **PLAIN)
    np.testing.assert_allclose(cropped.features(observe(wide)), [5.5, 2], atol=1e-6)
    stretched = OnnxNetwork(str(network), output="mean", framing="stretch", **PLAIN)
    assert stretched.features(observe(wide))[0] == pytest.approx((22 + 4 * 200) / 8, abs=0.5)
    tall = np.repeat(PIXELS[:1, :1], 2, axis=0)  # one pixel wide: half of the square stays grey
    padded = OnnxNetwork(str(network), output="map", framing="pad", pool="none", mean=0, std=1)
    assert padded.features(observe(tall))[:4].tolist() in ([1, 0, 1, 0], [0, 1, 0, 1])


def test_a_sidecar_says_what_parameters_do_not(network: Path) -> None:
    beside = network.with_suffix(".yaml")
    beside.write_text("output: mean\nmean: [0, 0, 0]\nstd: 1\n")
    found = OnnxNetwork(str(network)).features(observe(PIXELS))
    np.testing.assert_allclose(found, [5.5, 2], atol=1e-6)
    other = OnnxNetwork(str(network), mean=1).features(observe(PIXELS))
    np.testing.assert_allclose(other, [4.5, 5 - 12 + 10], atol=1e-6)
    beside.write_text("output: mean\nmaen: 0\n")
    with pytest.raises(UsageError, match=r"tiny\.yaml sets 'maen'; did you mean 'mean'\?"):
        OnnxNetwork(str(network)).features(observe(PIXELS))
    beside.write_text("[")
    with pytest.raises(DataError, match=r"tiny\.yaml cannot be read"):
        OnnxNetwork(str(network)).features(observe(PIXELS))


def test_a_batch_is_as_images_one_by_one(network: Path) -> None:
    seen = [observe(np.roll(PIXELS, turn)) for turn in range(5)]
    for threads in (1, 2):
        cue = OnnxNetwork(str(network), output="mean", threads=threads, **PLAIN)
        np.testing.assert_array_equal(cue.transform(seen), [cue.features(each) for each in seen])


def test_grey_tiny_huge_and_upside_down_images_are_images(network: Path) -> None:
    cue = OnnxNetwork(str(network), output="mean", **PLAIN)
    grey = np.array([[10, 20], [30, 40]], np.uint8)
    for form in in_every_form(grey):
        np.testing.assert_allclose(cue.features(observe(form)), [25, 25 - 50 + 10], atol=1e-5)
    np.testing.assert_allclose(cue.features(observe(PIXELS[::-1, ::-1])), [5.5, 2], atol=1e-6)
    one = PIXELS[:1, :1]
    np.testing.assert_allclose(cue.features(observe(one)), [1, 6], atol=1e-6)
    huge = np.kron(PIXELS, np.ones((1000, 1500, 1), np.uint8))
    np.testing.assert_allclose(cue.features(observe(huge)), [5.5, 2], atol=1e-4)
    with pytest.raises(UnusableObservation, match="8-bit RGB"):
        cue.features(observe(np.zeros((2, 2), np.float32)))


def test_what_is_wrong_is_said_in_one_line(network: Path, tmp_path: Path) -> None:
    text = tmp_path / "text.onnx"
    text.write_text("no network")
    wrong: list[tuple[OnnxNetwork, str]] = [
        (OnnxNetwork(), "give an ONNX file"),
        (OnnxNetwork(str(tmp_path / "gone.onnx")), "gone.onnx cannot be read: No such file"),
        (OnnxNetwork(str(tmp_path)), "cannot be read: Is a directory"),
        (OnnxNetwork(str(text), output="mean"), "is no network that onnxruntime runs"),
        (OnnxNetwork(str(of_one_node(tmp_path / "a.onnx", "Nonsense"))), "Nonsense"),
        (OnnxNetwork(str(network)), "no output is named; available: map, mean"),
        (OnnxNetwork(str(network), output="maen"), "has no output 'maen'; did you mean 'mean'?"),
        (OnnxNetwork(str(network), output="mean", size=3), "takes images of 2x2 pixels"),
        (OnnxNetwork(str(network), output="mean", layout="nhwc"), "layout=nhwc"),
        (OnnxNetwork(str(of_bytes(tmp_path / "b.onnx")), mean=127.5), "takes pixels as bytes"),
        (OnnxNetwork(str(network), output="mean", framing="middle"), "framing is 'middle'"),
        (OnnxNetwork(str(network), output="mean", std=0), "std is 0"),
        (OnnxNetwork(str(network), output="mean", threads=0), "threads is 0"),
        (OnnxNetwork(str(tiny(tmp_path / "open.onnx", "open")), output="mean"), "give size"),
    ]
    for cue, reason in wrong:
        with pytest.raises(PlacecueError) as told:
            cue.features(observe(PIXELS))
        assert reason in str(told.value)
        assert "\n" not in str(told.value)


def test_a_network_that_takes_bytes_is_given_pixels_as_they_are(tmp_path: Path) -> None:
    cue = OnnxNetwork(str(of_bytes(tmp_path / "bytes.onnx")), pool="none")
    np.testing.assert_array_equal(cue.features(observe(PIXELS)), PIXELS.transpose(2, 0, 1).ravel())


def test_weights_in_another_file_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Nobody notes the digest of that file; also not where onnxruntime would look for it.
    cue = OnnxNetwork(str(with_weights_elsewhere(tmp_path / "a.onnx")))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError, match="keeps its weights in another file: save it as one"):
        cue.features(observe(PIXELS))


def test_what_is_not_finite_is_no_feature(tmp_path: Path) -> None:
    cue = OnnxNetwork(str(of_one_node(tmp_path / "log.onnx", "Log")), mean=0, std=1, pool="none")
    assert np.isfinite(cue.features(observe(PIXELS))).all()
    black = np.zeros_like(PIXELS)  # of which the logarithm is infinite
    with pytest.raises(UnusableObservation, match="NaN or infinite"):
        cue.features(observe(black))


def test_without_the_extra_it_says_what_to_install(
    network: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    imported = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name == "onnxruntime":
            raise ImportError("No module named 'onnxruntime'")
        return imported(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(UsageError, match=r"needs onnxruntime .*pip install 'placecue\[deep\]'"):
        OnnxNetwork(str(network), output="mean").features(observe(PIXELS))


def test_another_network_in_its_place_is_another_cue(network: Path, tmp_path: Path) -> None:
    registry = load_plugins(built_ins_only=True).registry
    seen = [Observation(0, image=PIXELS).of_log("log", Origin(Recording("log", "digest"), 0))]

    def cached() -> np.ndarray:
        with FeatureCache(tmp_path / "features", registry) as cache:
            cue = OnnxNetwork(str(network), output="mean", **PLAIN)
            return np.asarray(cache.extract(cue, seen).features)

    np.testing.assert_allclose(cached(), [[5.5, 2]], atol=1e-6)
    tiny(network, bias=1.0)
    np.testing.assert_allclose(cached(), [[6.5, 3]], atol=1e-6)


def test_a_model_refuses_another_network_than_its_own(network: Path) -> None:
    cue = OnnxNetwork(str(network), output="mean", **PLAIN)
    cue.prepare()
    known = cue.digest_
    tiny(network, bias=1.0)
    loaded = clone(cue)
    loaded.digest_ = known
    with pytest.raises(DataError, match=r"another network .* than the one that the model"):
        loaded.features(observe(PIXELS))
