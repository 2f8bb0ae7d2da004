"""placecue's own option files, each read once a process.

An evaluation composes a config for each of its methods, of much the same files.
"""

from __future__ import annotations

from copy import deepcopy
from typing import ClassVar

from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.core_plugins.importlib_resources_config_source import (
    ImportlibResourcesConfigSource,
)
from hydra.plugins.config_source import ConfigResult


class KeptConfigs(ImportlibResourcesConfigSource):
    """A package's options; they do not change while it is in use."""

    _kept: ClassVar[dict[tuple[str, str], ConfigResult]] = {}

    def load_config(self, config_path: str) -> ConfigResult:
        """Return an option of one's own, to be changed at will."""
        known = self.full_path(), config_path
        if known not in self._kept:
            self._kept[known] = super().load_config(config_path)
        return deepcopy(self._kept[known])


def keep(loader: ConfigLoaderImpl, configs: str) -> None:
    """Let a loader keep what it reads below a ``pkg://`` path."""
    sources = loader.repository.get_sources()
    sources[:] = [
        KeptConfigs(each.provider, configs) if each.full_path() == configs else each
        for each in sources
    ]
