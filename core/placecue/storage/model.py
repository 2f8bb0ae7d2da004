"""Model folders: a fitted pipeline as data.

``config.yaml`` is the config it was trained with, ``manifest.json`` says what it is made of and
what it was trained on, ``state.json`` and ``arrays.npz`` hold what was learned. The manifest is
written last and names the digests of the others, so a half-written folder is no model. Loading
never runs code from the folder.
"""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, cast
from zipfile import BadZipFile

import numpy as np

import placecue
from placecue.atomic import made, write_json, write_text
from placecue.components.hooks import Kind
from placecue.components.pipelines import build_pipeline, components_of, describe_pipeline
from placecue.components.registry import Registry
from placecue.errors import DataError, PlacecueError, PluginError
from placecue.learning.rejection import Rejection
from placecue.pipeline import Pipeline
from placecue.source import Source
from placecue.storage.arrays import write_arrays
from placecue.storage.state import Decoder, Encoder

FORMAT = "placecue/model"
FORMAT_VERSION = 1
MANIFEST, CONFIG, STATE, ARRAYS = "manifest.json", "config.yaml", "state.json", "arrays.npz"
PACKAGES = ("placecue", "numpy", "scipy", "scikit-learn", "opencv-contrib-python-headless", "numba")


def save_model(
    pipeline: Pipeline,
    folder: Path,
    registry: Registry,
    *,
    trained_on: Iterable[Source] = (),
    config: Mapping[str, Any] | None = None,
) -> Path:
    """Write a fitted pipeline into a folder.

    Parameters
    ----------
    pipeline : Pipeline
        A fitted pipeline of registered components.
    folder : Path
        Where to; made if it is not there. A model that is there is replaced.
    registry : Registry
        Names the components.
    trained_on : iterable of Source
        The logs, whose digests the manifest records.
    config : mapping, optional
        The resolved config of the run; by default that of the pipeline alone.

    Returns
    -------
    Path
        The folder.
    """
    composition = describe_pipeline(pipeline, registry)
    encoder = Encoder(registry)
    state = {
        "cues": {
            name: {
                "cue": encoder.state(model.cue, f"cues.{name}"),
                "classifier": encoder.state(model.classifier, f"cues.{name}.classifier"),
            }
            for name, model in pipeline.cues.items()
        },
        "integrator": encoder.state(pipeline.integrator, "integrator"),
    }
    if pipeline.rejection_ is not None:
        state["rejection"] = asdict(pipeline.rejection_)
    made(folder)
    (folder / MANIFEST).unlink(missing_ok=True)
    write_text(folder / CONFIG, _as_yaml(config or composition))
    write_json(folder / STATE, state)
    write_arrays(folder / ARRAYS, encoder.arrays)
    manifest = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "classes": list(pipeline.classes),
        "pipeline": composition,
        "plugins": _plugins(composition, registry),
        "logs": [
            {"name": log.name, "digest": log.digest(), "metadata": dict(log.metadata)}
            for log in trained_on
        ],
        "versions": {"python": platform.python_version(), **_versions()},
        "digests": {name: _digest(folder / name) for name in (STATE, ARRAYS)},
    }
    write_json(folder / MANIFEST, manifest)
    return folder


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read what a model folder says it is.

    Raises
    ------
    DataError
        If the folder is not a model of a known version.
    """
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except OSError as error:
        reason = "it does not exist" if not folder.exists() else f"it has no readable {MANIFEST}"
        raise DataError(
            f"{folder} is not a model folder: {reason}; make one with placecue train out={folder}"
        ) from error
    except ValueError as error:
        raise DataError(f"{folder / MANIFEST} is damaged: {error}") from error
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        raise DataError(f"{folder / MANIFEST} is not the manifest of a placecue model")
    if manifest.get("format_version") != FORMAT_VERSION:
        raise DataError(
            f"{folder} is a model of format {manifest.get('format_version')}; this placecue "
            f"{placecue.__version__} reads format {FORMAT_VERSION}: train it again"
        )
    return manifest


def load_model(folder: Path, registry: Registry) -> Pipeline:
    """Read a pipeline back; its predictions are the same to the last bit.

    Raises
    ------
    DataError
        If the folder is not a model, or is damaged.
    PluginError
        If a plugin that the model was made with is not installed.
    """
    manifest = read_manifest(folder)
    try:
        _check_plugins(manifest["plugins"], registry, folder)
        for name, digest in manifest["digests"].items():
            if name not in (STATE, ARRAYS) or _digest(folder / name) != digest:
                raise DataError(f"{folder / name} is not the file that its manifest describes")
        state = json.loads((folder / STATE).read_text(encoding="utf-8"))
        with np.load(folder / ARRAYS, allow_pickle=False) as arrays:
            return _restore(manifest["pipeline"], state, Decoder(registry, dict(arrays)))
    except PlacecueError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError, BadZipFile) as error:
        raise DataError(
            f"the model {folder} is damaged ({type(error).__name__}: {error}); train it again"
        ) from error


def _restore(composition: Mapping[str, Any], state: Any, decoder: Decoder) -> Pipeline:
    pipeline = build_pipeline(composition, decoder.registry)
    for name, model in pipeline.cues.items():
        decoder.restore(model.cue, state["cues"][name]["cue"])
        decoder.restore(model.classifier, state["cues"][name]["classifier"])
    decoder.restore(pipeline.integrator, state["integrator"])
    if "rejection" in state:
        pipeline.rejection_ = Rejection(**state["rejection"])
    return pipeline


def _plugins(composition: Mapping[str, Any], registry: Registry) -> list[dict[str, str]]:
    provided = (registry.get(*named) for named in sorted(set(components_of(composition, registry))))
    return [
        {
            "kind": each.component.kind,
            "name": each.component.name,
            "distribution": each.distribution,
            "version": each.version,
        }
        for each in provided
    ]


def _check_plugins(plugins: list[dict[str, str]], registry: Registry, folder: Path) -> None:
    for plugin in plugins:
        if plugin["name"] not in registry.names(cast(Kind, plugin["kind"])):
            raise PluginError(
                f"the model {folder} needs {plugin['kind']} '{plugin['name']}' of the plugin "
                f"{plugin['distribution']} {plugin['version']}, which is not installed or did not "
                f"load: pip install {plugin['distribution']}, then see placecue plugins"
            )


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _as_yaml(data: Mapping[str, Any]) -> str:
    from omegaconf import OmegaConf

    return OmegaConf.to_yaml(OmegaConf.create(dict(data)))
