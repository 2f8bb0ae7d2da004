"""Where a command gets features from: the cache that its config names, or the cues alone."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from placecue.components.manager import Plugins
from placecue.errors import UsageError
from placecue.user_folders import cache_folder

if TYPE_CHECKING:
    from placecue.extraction import Extraction

log = logging.getLogger(__name__)


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

    folder, max_size = cache_of(config)
    if folder is None:
        return nullcontext(Extraction())
    from placecue.storage.feature_cache import FeatureCache

    return FeatureCache(folder, plugins.registry, max_size)


def cache_of(config: Mapping[str, Any]) -> tuple[Path | None, float | None]:
    """Return the folder of the feature cache and its largest size, GB; None for none.

    Raises
    ------
    UsageError
        If the folder is no path, or the size not 0 or more.
    """
    cache = config.get("cache") or {}
    if not isinstance(cache, Mapping):
        raise UsageError(f"cache must be a mapping with 'folder', or null, got {cache!r}")
    folder, max_size = cache.get("folder"), cache.get("max_size")
    if folder is not None and not isinstance(folder, str):
        raise UsageError(f"cache.folder must be a path or null, got {folder!r}")
    return _path(folder) if folder else None, at_least_0(max_size, "cache.max_size")


def _path(folder: str) -> Path | None:
    try:
        return cache_folder() if folder == "default" else Path(folder).expanduser()
    except RuntimeError:  # a user without a home
        log.warning(f"features are not kept: {folder} cannot be found; give cache.folder=PATH")
        return None


def at_least_0(value: Any, name: str) -> float | None:
    """Return a number of at least 0, or None.

    Raises
    ------
    UsageError
        If it is neither.
    """
    if value is None:
        return None
    if isinstance(value, (int, float)) and not isinstance(value, bool) and value >= 0:
        return float(value)
    raise UsageError(f"{name} must be a number of at least 0, or null, got {value!r}")
