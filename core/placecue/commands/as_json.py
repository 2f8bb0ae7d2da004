"""``json=true``: results as one JSON document on standard output, and nothing besides."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from placecue.checks import check_flag


def wanted(config: Mapping[str, Any]) -> bool:
    """Tell whether a config asks for JSON.

    Raises
    ------
    UsageError
        If ``json`` is neither true nor false.
    """
    told: bool = config.get("json", False)
    check_flag("json", told)
    return told


def tell(data: Any) -> None:
    """Print a document."""
    print(json.dumps(data, indent=2, default=str, ensure_ascii=True))


def paths(written: Iterable[tuple[str, Path]]) -> dict[str, str]:
    """Return what was written where, as a document holds it."""
    return {what: str(path) for what, path in written}
