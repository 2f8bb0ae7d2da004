"""The manifest of a model folder: what the model is made of, and what its files must be.

It is read before anything else, and nothing in it is taken on trust: every entry is of a known
type, and the digest of the manifest itself, kept in it, tells a slip of the disk or of an editor.
Who rewrites a manifest on purpose can choose other built-in components and other parameters, and
gets a model that was not trained like that; running code or reaching other files it cannot.
"""

from __future__ import annotations

import hashlib
import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import placecue
from placecue.components.hooks import KINDS
from placecue.components.pipelines import NOT_IN_PIPELINES
from placecue.errors import DataError, UsageError
from placecue.storage import strict_json
from placecue.storage.guarded import read_bytes

FORMAT = "placecue/model"
FORMAT_VERSION = 2
MANIFEST, CONFIG, STATE, ARRAYS = "manifest.json", "config.yaml", "state.json", "arrays.npz"
#: Bytes that a JSON file of a model may take; in memory it takes some 25 times as much at worst.
LIMIT = 4 * 2**20
#: Stands for the digest of a manifest while that is computed.
_BLANK = "0" * 64
_ENTRIES: dict[str, type] = {
    "created": str,
    "classes": list,
    "pipeline": dict,
    "plugins": list,
    "logs": list,
    "versions": dict,
    "files": dict,
}
_PLUGIN = ("kind", "name", "distribution", "version", "component_version")


def sealed(manifest: Mapping[str, Any]) -> bytes:
    """Return a manifest as the text of its file, with its own digest.

    Raises
    ------
    UsageError
        If it is larger than what is read back.
    """
    text = small({"digest": _BLANK, **manifest}, "the manifest of the model")
    return text.replace(_BLANK.encode(), _digest(text).encode(), 1)


def small(data: Any, what: str) -> bytes:
    """Return data as JSON that may stand in a model folder.

    Raises
    ------
    UsageError
        If it is larger than what is read back.
    """
    try:
        text = strict_json.dumps(data)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{what} cannot be written as JSON: {error}") from error
    if len(text) > LIMIT:
        raise UsageError(
            f"{what} takes {len(text) / 2**20:.0f} MiB as JSON, more than the {LIMIT // 2**20} "
            "that a model folder can hold: keep large things that are learned in numpy arrays"
        )
    return text


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read what a model folder says it is.

    Raises
    ------
    DataError
        If the folder is not a model of a known version, or its manifest is damaged.
    """
    path = folder / MANIFEST
    try:
        data = read_bytes(path, LIMIT)
    except DataError as error:
        unreadable = f"it has no readable {MANIFEST} ({error})"
        reason = unreadable if folder.exists() else "it does not exist"
        raise DataError(
            f"{folder} is not a model folder: {reason}; make one with placecue train out={folder}"
        ) from error
    manifest = strict_json.loads(data, path)
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        raise DataError(f"{path} is not the manifest of a placecue model")
    if manifest.get("format_version") != FORMAT_VERSION:
        raise DataError(_of_another_format(folder, manifest.get("format_version")))
    _check_seal(manifest.get("digest"), data, path)
    _check(manifest, path)
    return manifest


def _check_seal(digest: Any, data: bytes, path: Path) -> None:
    if not isinstance(digest, str) or len(digest) != len(_BLANK):
        raise _damaged(path, "it has no digest of itself")
    if _digest(data.replace(digest.encode(), _BLANK.encode(), 1)) != digest:
        raise _damaged(path, "it is not what was written")


def _check(manifest: dict[str, Any], path: Path) -> None:
    for entry, kind in _ENTRIES.items():
        if not isinstance(manifest.get(entry), kind):
            raise _damaged(path, f"its entry '{entry}' is missing or no {kind.__name__}")
    _check_classes(manifest["classes"], path)
    for plugin in manifest["plugins"]:
        _check_plugin(plugin, path)
    _check_files(manifest["files"], path)


def _check_classes(classes: list[Any], path: Path) -> None:
    texts = all(isinstance(each, str) for each in classes)
    if not texts or len(classes) < 2 or classes != sorted(set(classes)):
        raise _damaged(path, "its 'classes' are not two names or more, sorted")


def _check_plugin(plugin: Any, path: Path) -> None:
    if not isinstance(plugin, dict) or not all(_is_word(plugin.get(key)) for key in _PLUGIN):
        raise _damaged(path, f"each of its 'plugins' needs {', '.join(_PLUGIN)}, in one word")
    if plugin["kind"] not in KINDS or plugin["kind"] in NOT_IN_PIPELINES:
        raise _damaged(path, f"no model is made of a {plugin['kind']!r:.80}")


def _is_word(value: Any) -> bool:
    """Tell whether a value is a name or version; messages tell people to install such."""
    return isinstance(value, str) and re.fullmatch(r"[\w.+!-]{1,100}", value) is not None


def _check_files(files: dict[str, Any], path: Path) -> None:
    if set(files) != {STATE, ARRAYS}:
        raise _damaged(path, f"its 'files' are not {STATE} and {ARRAYS}")
    for about in files.values():
        if (
            not isinstance(about, dict)
            or type(about.get("size")) is not int
            or not isinstance(about.get("sha256"), str)
        ):
            raise _damaged(path, "a file in it has no size or no sha256")


def _of_another_format(folder: Path, version: Any) -> str:
    said = f"{folder} is a model of format {version!r:.20}; this placecue {placecue.__version__} "
    said += f"reads format {FORMAT_VERSION}: train it again"
    if version != 1 or not _has_log(folder / CONFIG):
        return said
    again = f"placecue train --config-dir {shlex.quote(str(folder))} --config-name config"
    return f"{said} as it was, {again} out=NEW"


def _has_log(config: Path) -> bool:
    """Tell whether a config is that of a command, which names its log."""
    try:
        lines = read_bytes(config, LIMIT).splitlines()
    except DataError:
        return False
    return any(line.startswith(b"log:") for line in lines)


def _digest(text: bytes) -> str:
    """Return the digest of a manifest in which its own stands blank."""
    return hashlib.sha256(text).hexdigest()


def _damaged(path: Path, why: str) -> DataError:
    return DataError(f"{path} is damaged: {why}; train the model again")
