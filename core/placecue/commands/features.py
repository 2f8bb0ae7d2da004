"""Where a command gets features from: the cache that its config names, or the cues alone."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from placecue.discovery.manager import Plugins
from placecue.errors import UsageError

if TYPE_CHECKING:
    from placecue.extraction import Extraction


def extraction_of(
    config: Mapping[str, Any], plugins: Plugins
) -> AbstractContextManager[Extraction]:
    """Return how features come from observations, to be used in a ``with`` block.

    Parameters
    ----------
    config : mapping
        ``cache`` with ``folder`` (null for none) and ``max_size``, GB.
    plugins : Plugins
        Names the cues.

    Raises
    ------
    UsageError
        If the size is not 0 or more.
    """
    from placecue.extraction import Extraction

    folder = cache_of(config)
    if folder is None:
        return nullcontext(Extraction())
    from placecue.storage.feature_cache import FeatureCache

    return FeatureCache(folder, plugins.registry, config["cache"]["max_size"])


def cache_of(config: Mapping[str, Any]) -> Path | None:
    """Return the folder of the feature cache, or None.

    Raises
    ------
    UsageError
        If it is no path.
    """
    folder = (config.get("cache") or {}).get("folder")
    if folder is None or isinstance(folder, str):
        return Path(folder).expanduser() if folder else None
    raise UsageError(f"cache.folder must be a path or null, got {folder!r}")
