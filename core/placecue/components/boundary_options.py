"""The options of boundaries, such that several can be chosen.

``boundaries/NAME`` places ``boundary/NAME`` under its name:
``boundaries@accumulator.boundary=[door,evidence]``.
"""

from __future__ import annotations

from hydra.core.object_type import ObjectType
from hydra.plugins.config_source import ConfigResult, ConfigSource
from omegaconf import OmegaConf

from placecue.components.manager import current_plugins
from placecue.components.options import BUILT_IN_CONFIGS, option_files

BOUNDARIES = "boundaries"


class BoundaryOptions(ConfigSource):
    """Options ``boundaries/NAME`` for every boundary."""

    @staticmethod
    def scheme() -> str:  # noqa: D102
        return BOUNDARIES

    def available(self) -> bool:  # noqa: D102
        return True

    def is_group(self, config_path: str) -> bool:  # noqa: D102
        return config_path.strip("/") in ("", BOUNDARIES)

    def is_config(self, config_path: str) -> bool:  # noqa: D102
        group, _, name = config_path.strip("/").removesuffix(".yaml").partition("/")
        return group == BOUNDARIES and name in _names()

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:  # noqa: D102
        group = config_path.strip("/")
        if group == "":
            return [] if results_filter is ObjectType.CONFIG else [BOUNDARIES]
        return [] if results_filter is ObjectType.GROUP or group != BOUNDARIES else _names()

    def load_config(self, config_path: str) -> ConfigResult:  # noqa: D102
        name = config_path.strip("/").removesuffix(".yaml").partition("/")[2]
        option = OmegaConf.create({"defaults": [{f"/boundary@{name}": name}]})
        return ConfigResult(self.provider, self.full_path(), option, header={"package": None})


def _names() -> list[str]:
    files = (
        option.removesuffix(".yaml").partition("/")
        for path in (BUILT_IN_CONFIGS, *current_plugins().config_paths)
        for option in option_files(path)
    )
    written = {name for group, _, name in files if group == "boundary"}
    return sorted({*current_plugins().registry.names("boundary"), *written})
