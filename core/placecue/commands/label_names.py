"""Maps of labels with any letters: as text, or in a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from omegaconf import OmegaConf

from placecue.errors import UsageError


def with_names(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return a config whose ``label_map`` is a mapping, whatever way it was given."""
    names = config.get("label_map")
    return {**config, "label_map": read_names(names) if isinstance(names, str) else names}


def read_names(given: str) -> Any:
    """Return the map that a text or a file holds, in YAML or JSON.

    Hydra's own words for mappings know few letters: ``label_map={Büro 1: office}`` comes here.

    Parameters
    ----------
    given : str
        Such as ``{"Büro 1": office, hall: null}``, or the path of a file of such lines.

    Raises
    ------
    UsageError
        If there is no such file, or it does not parse.
    """
    text, where = given, "label_map"
    if not given.lstrip().startswith("{"):
        where = f"label_map={given}"
        try:
            text = Path(given).expanduser().read_text("utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise UsageError(
                f"{where} is no map such as {{BO: office}}, and no file that can be read: {error}"
            ) from error
    try:
        return OmegaConf.to_container(OmegaConf.create(text), resolve=False)
    except Exception as error:  # parsers of YAML raise their own
        raise UsageError(f"{where} is no map of labels: {' '.join(str(error).split())}") from error
