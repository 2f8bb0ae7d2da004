"""The options of cues as parts of a cue that is made of cues.

``part/NAME`` is ``cue/NAME`` without its classifier. ``parts/NAME`` places it under its name, so
that several can be chosen in one list: ``parts@cues.joint.parts=[crfh,laser]``.
"""

from __future__ import annotations

from importlib.resources.abc import Traversable
from typing import Any, cast

from hydra.core.object_type import ObjectType
from hydra.plugins.config_source import ConfigResult, ConfigSource
from omegaconf import DictConfig, OmegaConf

from placecue.components.manager import current_plugins
from placecue.components.options import BUILT_IN_CONFIGS, default_option, option_files, root_of

PART, PARTS = "part", "parts"


class PartOptions(ConfigSource):
    """Options ``part/NAME`` and ``parts/NAME`` for every cue."""

    @staticmethod
    def scheme() -> str:  # noqa: D102
        return PARTS

    def available(self) -> bool:  # noqa: D102
        return True

    def is_group(self, config_path: str) -> bool:  # noqa: D102
        return config_path.strip("/") in ("", PART, PARTS)

    def is_config(self, config_path: str) -> bool:  # noqa: D102
        group, name = _parted(config_path)
        return group in (PART, PARTS) and name in _names()

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:  # noqa: D102
        group = config_path.strip("/")
        if group == "":
            return [] if results_filter is ObjectType.CONFIG else [PART, PARTS]
        return [] if results_filter is ObjectType.GROUP or not self.is_group(group) else _names()

    def load_config(self, config_path: str) -> ConfigResult:  # noqa: D102
        group, name = _parted(config_path)
        placed = {"defaults": [{f"/{PART}@{name}": name}]}
        option = part_option(name) if group == PART else OmegaConf.create(placed)
        return ConfigResult(self.provider, self.full_path(), option, header={"package": None})


def part_option(name: str) -> DictConfig:
    """Return the option of a cue without what it says of its classifier."""
    path = cue_files().get(name)
    if path is None:
        option = default_option("cue", name)
    else:
        option = cast(DictConfig, OmegaConf.create(path.read_text(encoding="utf-8")))
    chosen = [each for each in option.get("defaults", []) if not _of_classifier(each)]
    kept = {key: each for key, each in option.items_ex(resolve=False) if key != "classifier"}
    return OmegaConf.create({**kept, "defaults": chosen})


def _of_classifier(default: Any) -> bool:
    """Tell whether an entry of a defaults list is about the classifier, or something inside it."""
    if not isinstance(default, DictConfig):
        return False
    chosen = str(next(iter(default))).removeprefix("override ")
    return chosen.partition("@")[2].partition(".")[0] == "classifier"


def cue_files() -> dict[str, Traversable]:
    """Return the option files of cues by name, the first of each."""
    found: dict[str, Traversable] = {}
    for path in (BUILT_IN_CONFIGS, *current_plugins().config_paths):
        for option in option_files(path):
            group, name = _parted(option)
            if group == "cue":
                found.setdefault(name, root_of(path) / option)
    return found


def _names() -> list[str]:
    return sorted({*current_plugins().registry.names("cue"), *cue_files()})


def _parted(path: str) -> tuple[str, str]:
    group, _, name = path.strip("/").removesuffix(".yaml").partition("/")
    return group, name
