"""What tests do to model folders: change their files, and make digests right again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


def reseal(folder: Path) -> bool:
    """Write the digests and sizes of the files as they are; False where nothing can be sealed."""
    path = folder / "manifest.json"
    try:
        # No more than a test can parse without taking the memory that it measures.
        small = path.is_file() and path.stat().st_size < 2**20
        manifest = json.loads(path.read_bytes()) if small else None
        for name, about in (manifest.get("files") or {}).items():
            data = (folder / name).read_bytes() if (folder / name).is_file() else b""
            about |= {"size": len(data), "sha256": hashlib.sha256(data).hexdigest()}
        manifest = {"digest": "0" * 64} | {k: v for k, v in manifest.items() if k != "digest"}
        text = json.dumps(manifest)
        path.write_text(text.replace("0" * 64, hashlib.sha256(text.encode()).hexdigest(), 1))
    except (ValueError, TypeError, KeyError, AttributeError, OSError, RecursionError):
        return False
    return True


def edit(folder: Path, name: str, change: Callable[[Any], Any], sealed: bool = True) -> None:
    """Change the data of a JSON file in place; with the digests made right, or as they were."""
    path = folder / name
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))
    if sealed:
        reseal(folder)
