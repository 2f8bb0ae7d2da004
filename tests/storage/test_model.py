"""Model folders are data: the same predictions to the last bit, and no code."""

import json
import logging
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml
from omegaconf import OmegaConf
from scipy import sparse

from folders import reseal
from placecue import DataError, DescriptorSets, Pipeline, PluginError, Unknown, UsageError
from placecue.components.registry import Registry
from placecue.storage import strict_json
from placecue.storage.model import load_model, read_manifest, save_model
from placecue.storage.state import Decoder, Encoder
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from toys import PLACES, Beams, Walk, pipeline, registry


@pytest.fixture(scope="module")
def known() -> Registry:
    return registry()


@pytest.fixture(scope="module")
def fitted() -> Pipeline:
    return pipeline().fit(Walk())


@pytest.fixture
def folder(fitted: Pipeline, known: Registry, tmp_path: Path) -> Path:
    return save_model(fitted, tmp_path / "model", known, trained_on=[Walk()])


def test_predictions_are_the_same_to_the_last_bit(
    fitted: Pipeline, folder: Path, known: Registry
) -> None:
    loaded = load_model(folder, known)
    walk = list(Walk(rounds=1, seed=1))
    for before, after in zip(fitted.beliefs(walk), loaded.beliefs(walk), strict=True):
        assert before.scores.values.tobytes() == after.scores.values.tobytes()
        assert before.scores.layout == after.scores.layout
        assert (before.label, before.confidence) == (after.label, after.confidence)


def test_a_search_is_kept_with_the_model(known: Registry, tmp_path: Path) -> None:
    svm = SVM(kernel=RBF(), search={"C": [1.0, 10.0], "gamma": [0.1]}, multiclass="modified_oaa")
    trained = Pipeline({"beams": (Beams(), svm)}).fit(Walk())
    loaded = load_model(save_model(trained, tmp_path / "m", known), known)
    assert loaded.cues["beams"].classifier.search_ == svm.search_
    assert loaded.cues["beams"].classifier.kernel_.gamma == 0.1
    assert loaded.cues["beams"].classifier.layout_ == svm.layout_


def test_a_threshold_for_unknown_is_kept_with_the_model(known: Registry, tmp_path: Path) -> None:
    cues = {"beams": (Beams(), SVM(kernel=RBF(gamma=0.1)))}
    trained = Pipeline(cues, unknown=Unknown(false_accept_rate=0.3)).fit(Walk(noise=1.0))
    loaded = load_model(save_model(trained, tmp_path / "m", known), known)
    assert trained.rejection_ is not None
    assert (loaded.unknown, loaded.rejection_) == (trained.unknown, trained.rejection_)
    walk = list(Walk(seed=1, noise=1.0))
    labels = [belief.label for belief in loaded.beliefs(walk)]
    assert labels == [belief.label for belief in trained.beliefs(walk)]
    assert set(labels) > {"unknown"}


def test_a_model_that_knows_nothing_of_unknown_loads(
    fitted: Pipeline, folder: Path, known: Registry
) -> None:
    assert "rejection" not in json.loads((folder / "state.json").read_text())
    manifest = json.loads((folder / "manifest.json").read_text())
    del manifest["pipeline"]["unknown"]  # as it was before there was one
    (folder / "manifest.json").write_text(json.dumps(manifest))
    reseal(folder)
    loaded = load_model(folder, known)
    assert (loaded.unknown, loaded.rejection_) == (None, None)


def test_the_manifest_says_what_the_model_is_made_of(folder: Path) -> None:
    manifest = read_manifest(folder)
    assert manifest["classes"] == list(PLACES)
    assert manifest["logs"] == [
        {"name": "walk 0", "digest": "walk-4-20-0-0.4", "metadata": {}},
    ]
    assert manifest["versions"]["placecue"] == "0.1.0"
    made_of = {(each["kind"], each["name"]): each for each in manifest["plugins"]}
    assert set(made_of) == {
        ("cue", "beams"),
        ("cue", "brightness"),
        ("classifier", "svm"),
        ("kernel", "rbf"),
        ("integrator", "svm_das"),
        ("scaling", "range"),
        ("folds", "interleaved"),
        ("layout", "one_against_all"),
        ("layout", "one_against_one"),
    }
    assert made_of["cue", "beams"]["distribution"] == "toys"
    config = yaml.safe_load((folder / "config.yaml").read_text())
    assert config["cues"]["beams"]["classifier"]["kernel"] == {"plugin": "rbf", "gamma": 0.1}


def test_no_file_of_the_model_is_a_pickle(folder: Path) -> None:
    assert sorted(path.name for path in folder.iterdir()) == [
        "arrays.npz",
        "config.yaml",
        "manifest.json",
        "state.json",
    ]
    with np.load(folder / "arrays.npz", allow_pickle=False) as arrays:
        assert all(arrays[name].dtype != object for name in arrays.files)


def test_a_missing_plugin_is_named(folder: Path, known: Registry) -> None:
    from placecue.components.manager import load_plugins

    with pytest.raises(PluginError, match=r"needs cue 'beams' of the plugin toys 1\.0"):
        load_model(folder, load_plugins(built_ins_only=True).registry)


def test_what_is_no_model_is_refused_in_one_line(
    folder: Path, known: Registry, tmp_path: Path
) -> None:
    with pytest.raises(DataError, match="does not exist"):
        load_model(tmp_path / "nowhere", known)
    with pytest.raises(DataError, match=r"no readable manifest\.json"):
        load_model(tmp_path, known)
    (folder / "manifest.json").write_text("{")
    with pytest.raises(DataError, match="is damaged"):
        load_model(folder, known)
    (folder / "manifest.json").write_text('{"format": "something"}')
    with pytest.raises(DataError, match="not the manifest"):
        load_model(folder, known)


@pytest.mark.parametrize("name", ["arrays.npz", "state.json"])
def test_a_damaged_file_is_noticed(folder: Path, known: Registry, name: str) -> None:
    data = bytearray((folder / name).read_bytes())
    data[len(data) // 2] ^= 1
    (folder / name).write_bytes(bytes(data))
    with pytest.raises(DataError, match=f"{name} is not the file that its manifest describes"):
        load_model(folder, known)


def test_a_manifest_of_another_version_is_refused(folder: Path, known: Registry) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["format_version"] = 99
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(DataError, match="format 99"):
        load_model(folder, known)


@pytest.mark.parametrize("fails", ["savez", "to_yaml"])
def test_a_model_that_fails_half_way_is_no_model_and_leaves_the_old_one_whole(
    fitted: Pipeline, known: Registry, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, fails: str
) -> None:
    old = Pipeline({"beams": (Beams(), SVM(kernel=RBF()))}).fit(Walk(rounds=2, stay=5))
    folder = save_model(old, tmp_path / "old", known)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}

    def fail(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr({"savez": np, "to_yaml": OmegaConf}[fails], fails, fail)
    for to in (folder, tmp_path / "new"):
        with pytest.raises(DataError, match="No space left"):
            save_model(fitted, to, known)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    with pytest.raises(DataError, match="not a model folder"):
        load_model(tmp_path / "new", known)
    assert not list((tmp_path / "new").iterdir())


def test_a_model_that_was_replaced_in_part_is_no_model(
    fitted: Pipeline, folder: Path, known: Registry, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace, done = Path.replace, []

    def killed(path: Path, target: Path) -> Path:
        if len(done) == 2:
            raise KeyboardInterrupt
        done.append(target)
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", killed)
    other = Pipeline({"beams": (Beams(), SVM(kernel=RBF()))}).fit(Walk(rounds=2, stay=5))
    with pytest.raises(KeyboardInterrupt):
        save_model(other, folder, known)
    assert len(done) == 2
    with pytest.raises(DataError, match=r"(state|arrays)\.\w+ is not the file that its manifest"):
        load_model(folder, known)


def test_the_other_version_of_a_component_is_refused_or_warned_of(
    fitted: Pipeline,
    folder: Path,
    known: Registry,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(Beams, "version", "2")
    said = r"cue 'beams' of version 1 \(toys 1\.0\), and version 2 is installed"
    with pytest.raises(PluginError, match=said):
        load_model(folder, known)
    with caplog.at_level(logging.WARNING, "placecue"):
        loaded = load_model(folder, known, "warn")
    assert re.search(said, caplog.text)
    assert list(loaded.cues) == list(fitted.cues)
    with pytest.raises(UsageError, match="must be refuse or warn, got 'ignore'"):
        load_model(folder, known, "ignore")  # type: ignore[arg-type]


def test_the_other_version_of_a_component_inside_another_is_refused(
    folder: Path, known: Registry, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(RBF, "version", "1.1")
    with pytest.raises(PluginError, match=r"kernel 'rbf' of version 1 .* version 1\.1 is inst"):
        load_model(folder, known)


class Forgetful(Beams):
    """Learns under a name that says nothing of it."""

    def fit(self, observations: object, labels: object = None) -> "Forgetful":
        self.seen = 3
        return self


def test_what_is_learned_under_another_name_is_refused_not_lost(known: Registry) -> None:
    learned = Forgetful().fit([])
    with pytest.raises(UsageError, match=r"cues\.b\.seen is neither a parameter nor .* seen_"):
        Encoder(known).state(learned, "cues.b")
    del learned.seen
    learned._worked_out = 1
    assert Encoder(known).state(learned, "cues.b") == {}


def test_a_name_with_bytes_that_are_no_text_is_written(known: Registry, tmp_path: Path) -> None:
    walk = Walk(rounds=2, stay=5)
    walk.name = b"log\xff.mcap".decode("utf-8", "surrogateescape")
    trained = Pipeline({"beams": (Beams(), SVM(kernel=RBF()))}).fit(walk)
    folder = save_model(trained, tmp_path / "m", known, trained_on=[walk])
    assert read_manifest(folder)["logs"][0]["name"] == "log\\udcff.mcap"


def test_numbers_that_json_has_no_word_for(known: Registry) -> None:
    component = Beams()
    component.far_, component.none_ = -np.inf, [np.nan, 1.5]
    restored = Beams()
    state = strict_json.loads(strict_json.dumps(Encoder(known).state(component, "b")), "b")
    Decoder(known, {}).restore(restored, state)
    assert restored.far_ == -np.inf
    assert np.isnan(restored.none_[0])
    assert restored.none_[1] == 1.5


def test_the_state_of_a_component_cannot_set_what_is_not_learned(known: Registry) -> None:
    with pytest.raises(DataError, match="no learned attribute"):
        Decoder(known, {}).restore(Beams(), {"__class__": 1})
    with pytest.raises(DataError, match="no learned attribute"):
        Decoder(known, {}).restore(Beams(), {"extract": 1})
    with pytest.raises(DataError, match="no learned attribute"):
        Decoder(known, {}).restore(SVM(), {"classes_": 1})  # a property


def test_every_kind_of_learned_value_survives(known: Registry) -> None:
    component = Beams()
    component.number_ = np.float64(0.1)
    component.names_ = ["a", ("b", 2), {"c": None}]
    component.words_ = np.array(["office", "kitchen"])
    component.sparse_ = sparse.csr_array(([1.5], ([0], [28**6 - 1])), shape=(1, 28**6))
    component.sets_ = DescriptorSets(np.ones((3, 2), np.float32), np.array([0, 1, 3]))
    encoder = Encoder(known)
    state = json.loads(json.dumps(encoder.state(component, "beams")))
    restored = Beams()
    Decoder(known, encoder.arrays).restore(restored, state)
    assert restored.number_ == component.number_
    assert restored.names_ == component.names_
    assert restored.words_.tolist() == ["office", "kitchen"]
    assert (restored.sparse_ != component.sparse_).nnz == 0
    assert restored.sets_.offsets.tolist() == [0, 1, 3]


def test_what_a_folder_cannot_hold_is_named(known: Registry) -> None:
    component = Beams()
    component.model_ = object()
    with pytest.raises(UsageError, match=r"cues\.beams\.model_ is a object"):
        Encoder(known).state(component, "cues.beams")


def test_a_component_that_is_not_registered_is_named(
    fitted: Pipeline, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    from placecue.components.manager import load_plugins

    with (
        caplog.at_level(logging.WARNING),
        pytest.raises(UsageError, match=r"toys\.Beams is no reg"),
    ):
        save_model(fitted, tmp_path / "m", load_plugins(built_ins_only=True).registry)
    assert not (tmp_path / "m").exists()
    shutil.rmtree(tmp_path)
