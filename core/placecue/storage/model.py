"""Model folders: a fitted pipeline as data.

``config.yaml`` is the config it was trained with, ``manifest.json`` says what it is made of and
what it was trained on, ``state.json`` and ``arrays.npz`` hold what was learned. The manifest takes
its place last and holds the digests of the others, so a half-written folder is no model. Loading
never runs code from the folder and writes nowhere.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from io import BufferedReader
from pathlib import Path
from typing import Any, TypeVar

from placecue.atomic import made, replacing
from placecue.components.parameter_types import misfits
from placecue.components.pipelines import build_pipeline, components_of, describe_pipeline
from placecue.components.registry import Registry
from placecue.errors import DataError, PluginError
from placecue.integration import unfitted
from placecue.learning.calibration import Calibration
from placecue.learning.rejection import Rejection
from placecue.pipeline import Pipeline
from placecue.scores import Layout
from placecue.source import Source
from placecue.storage import strict_json
from placecue.storage.arrays import arrays_in, save_arrays
from placecue.storage.guarded import opened, size_of
from placecue.storage.manifest import (
    ARRAYS,
    CONFIG,
    FORMAT,
    FORMAT_VERSION,
    LIMIT,
    MANIFEST,
    STATE,
    read_manifest,
    sealed,
    small,
)
from placecue.storage.state import Decoder, Encoder
from placecue.storage.versions import OtherVersions, check_installed, plugins_of

__all__ = ["load_model", "read_manifest", "save_model"]

T = TypeVar("T")
PACKAGES = ("placecue", "numpy", "scipy", "scikit-learn", "opencv-contrib-python-headless", "numba")


def save_model(
    pipeline: Pipeline,
    folder: Path,
    registry: Registry,
    *,
    trained_on: Iterable[Source] = (),
    earlier: Iterable[Mapping[str, Any]] = (),
    config: Mapping[str, Any] | None = None,
) -> Path:
    """Write a fitted pipeline into a folder.

    Parameters
    ----------
    pipeline : Pipeline
        A fitted pipeline of registered components.
    folder : Path
        Where to; made if it is not there. A model that is there stays whole until all files of
        the new one are written, and is then replaced.
    registry : Registry
        Names the components.
    trained_on : iterable of Source
        The logs, whose digests the manifest records.
    earlier : iterable of mapping
        What the manifest of a model says of the logs that it had been trained on before.
    config : mapping, optional
        The resolved config of the run; by default that of the pipeline alone.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    UsageError
        If a component is not registered, or has learned what a model folder cannot hold.
    DataError
        If writing fails; then there is no new model.
    """
    composition = describe_pipeline(pipeline, registry)
    encoder = Encoder(registry)
    state = small(_learned(pipeline, encoder), "what was learned")
    components = {*components_of(composition, registry), *encoder.components}
    about = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "classes": list(pipeline.classes),
        "pipeline": composition,
        "plugins": plugins_of(components, registry),
        "logs": [
            *(dict(each) for each in earlier),
            *(
                {"name": _text(log.name), "digest": log.digest(), "metadata": dict(log.metadata)}
                for log in trained_on
            ),
        ],
        "versions": {"python": platform.python_version(), **_versions()},
    }
    made(folder)
    with ExitStack() as stack:
        # What is entered first takes its place last.
        manifest, config_file, state_file, arrays_file = (
            stack.enter_context(replacing(folder / name))
            for name in (MANIFEST, CONFIG, STATE, ARRAYS)
        )
        save_arrays(arrays_file, encoder.arrays)
        state_file.write_bytes(state)
        config_file.write_text(_as_yaml(config or composition), encoding="utf-8")
        files = {STATE: _about(state_file), ARRAYS: _about(arrays_file)}
        manifest.write_bytes(sealed({**about, "files": files}))
    return folder


def load_model(
    folder: Path, registry: Registry, other_versions: OtherVersions = "refuse"
) -> Pipeline:
    """Read a pipeline back; its predictions are the same to the last bit.

    Parameters
    ----------
    folder : Path
        What :func:`save_model` wrote. It may come from anybody: nothing in it is run, and what is
        read is no larger than its files.
    registry : Registry
        Builds the components.
    other_versions : {"refuse", "warn"}
        What to do where an installed component has another version than the model was made with.

    Raises
    ------
    DataError
        If the folder is not a model, or is damaged.
    PluginError
        If a plugin that the model was made with is not installed, or in another version.
    """
    manifest = read_manifest(folder)
    check_installed(manifest["plugins"], registry, folder, other_versions)
    with _verified(folder / STATE, manifest) as file:
        if size_of(file) > LIMIT:
            raise DataError(f"{folder / STATE} is larger than the {LIMIT // 2**20} MiB it may have")
        state = strict_json.loads(file.read(LIMIT), folder / STATE)
    with _verified(folder / ARRAYS, manifest) as file:
        arrays = arrays_in(file, folder / ARRAYS)
    try:
        components = {(each["kind"], each["name"]) for each in manifest["plugins"]}
        return _restored(manifest, state, Decoder(registry, arrays, components))
    except PluginError:
        raise
    except Exception as error:  # damage has many names, and so has what a constructor raises
        what = "" if isinstance(error, DataError) else f"{type(error).__name__}: "
        reason = " ".join(f"{what}{error}".split())
        raise DataError(f"the model {folder} is damaged ({reason:.400}); train it again") from error


def _learned(pipeline: Pipeline, encoder: Encoder) -> dict[str, Any]:
    """Return what the parts of a pipeline have learned."""
    state: dict[str, Any] = {
        "cues": {
            name: {
                "cue": encoder.state(model.cue, f"cues.{name}"),
                "classifier": encoder.state(model.classifier, f"cues.{name}.classifier"),
            }
            for name, model in pipeline.cues.items()
        },
        "integrator": encoder.state(pipeline.integrator, "integrator"),
        "for_fewer": [
            {"cues": list(cues), "state": encoder.state(scheme, f"integrator of {'+'.join(cues)}")}
            for cues, scheme in pipeline.for_fewer_.items()
        ],
        "layout": encoder.encode(pipeline.layout_, "layout"),
    }
    if pipeline.rejection_ is not None:
        state["rejection"] = asdict(pipeline.rejection_)
    if pipeline.calibration_ is not None:
        state["calibration"] = asdict(pipeline.calibration_)
    return state


def _restored(manifest: Mapping[str, Any], state: Any, decoder: Decoder) -> Pipeline:
    """Build a pipeline and give it what it had learned, all of it and nothing else."""
    composition = manifest["pipeline"]
    if {*components_of(composition, decoder.registry)} - {*(decoder.components or ())}:
        raise DataError("its manifest does not name all components of its pipeline")
    pipeline = build_pipeline(composition, decoder.registry)
    if state["cues"].keys() != pipeline.cues.keys():
        raise DataError("what was learned is of other cues than those of the manifest")
    for name, model in pipeline.cues.items():
        decoder.restore(model.cue, state["cues"][name]["cue"])
        decoder.restore(model.classifier, state["cues"][name]["classifier"])
        _check_classes(name, model.classifier, manifest["classes"])
    decoder.restore(pipeline.integrator, state["integrator"])
    for each in state.get("for_fewer", []):  # models of an earlier version have none
        cues, scheme = tuple(each["cues"]), unfitted(pipeline.integrator)
        if not set(cues) < pipeline.cues.keys() or cues in pipeline.for_fewer_:
            raise DataError(f"it has an integrator of other cues than its own: {cues}")
        decoder.restore(scheme, each["state"])
        pipeline.for_fewer_[cues] = scheme
    pipeline.layout_ = _layout(decoder.decode(state.get("layout")), manifest["classes"])
    if "rejection" in state:
        pipeline.rejection_ = _told("rejection", state["rejection"], Rejection)
    if "calibration" in state:
        pipeline.calibration_ = _told("calibration", state["calibration"], Calibration)
    surplus = decoder.arrays.keys() - decoder.used
    if surplus:
        raise DataError(f"{len(surplus)} arrays belong to nothing, such as {min(surplus)!r:.80}")
    return pipeline


def _check_classes(name: str, classifier: Any, classes: list[str]) -> None:
    layout = getattr(classifier, "layout_", None)
    if not isinstance(layout, Layout):
        raise DataError(f"the classifier of cue '{name}' has no layout_ of scores")
    labels = getattr(classifier, "labels_", classes)
    if list(layout.classes) != classes or len(labels) != len(classes):
        raise DataError(f"the classifier of cue '{name}' has other classes than the manifest")


def _layout(layout: Any, classes: list[str]) -> Layout | None:
    """Check the layout of the integrated scores."""
    if layout is not None and not (isinstance(layout, Layout) and list(layout.classes) == classes):
        raise DataError("its integrated scores are of no layout of its classes")
    return layout


def _told(name: str, state: Any, kind: type[T]) -> T:
    """Return what a model says of itself, checked."""
    wrong = misfits(state, kind)
    if wrong:
        raise DataError(f"{name}: {'; '.join(wrong)}")
    return kind(**state)


@contextmanager
def _verified(path: Path, manifest: Mapping[str, Any]) -> Iterator[BufferedReader]:
    """Open a file of a model once it is known to be the one that the manifest describes."""
    said = manifest["files"][path.name]
    with opened(path) as file:
        if size_of(file) != said["size"] or _sha256(file) != said["sha256"]:
            raise DataError(f"{path} is not the file that its manifest describes")
        file.seek(0)
        yield file


def _about(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        return {"size": size_of(file), "sha256": _sha256(file)}


def _sha256(file: BufferedReader) -> str:
    return hashlib.file_digest(file, "sha256").hexdigest()


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def _text(name: str) -> str:
    """Return a name that can be written: that of a file need not be text."""
    return name.encode("utf-8", "backslashreplace").decode()


def _as_yaml(data: Mapping[str, Any]) -> str:
    from omegaconf import OmegaConf

    return OmegaConf.to_yaml(OmegaConf.create(dict(data)))
