"""Where the jobs of a sweep write, so that none writes over another's results."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any

from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import DictConfig, OmegaConf

OUT = "out"


def swept_keys(overrides: Iterable[str], parameters: Iterable[str] = ()) -> set[str]:
    """Return the keys that a sweep gives several values to.

    Parameters
    ----------
    overrides : iterable of str
        Those of the command line.
    parameters : iterable of str
        Keys that the config sweeps by itself, ``hydra.sweeper.params``.
    """
    parser = OverridesParser.create()
    parsed = map(parser.parse_override, overrides)
    return {each.key_or_group for each in parsed if each.is_sweep_override()} | set(parameters)


def of_job(out: Path, job: int, is_folder: bool) -> Path:
    """Return the place of one job: a folder in ``out``, or ``out`` with a number in its name."""
    return out / str(job) if is_folder else out.with_name(f"{out.stem}_{job}{out.suffix}")


def tells_jobs_apart(config: DictConfig, swept: Collection[str]) -> bool:
    """Tell whether ``out`` names everything that a sweep changes, so that it needs no number.

    Parameters
    ----------
    config : DictConfig
        The config of one job, its interpolations unresolved.
    swept : collection of str
        See :func:`swept_keys`.
    """
    named = _named_by(OUT, OmegaConf.to_container(config, resolve=False)) | {OUT}
    return all(any(name == key or name.startswith(f"{key}.") for name in named) for key in swept)


def _named_by(key: str, config: Any, seen: frozenset[str] = frozenset()) -> set[str]:
    """Return the keys that a value is made of, at any remove."""
    value: Any = config
    for part in key.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    found = set(re.findall(r"\$\{([\w.]+)\}", value)) if isinstance(value, str) else set()
    return found.union(
        *(_named_by(each, config, seen | found) for each in found if each not in seen)
    )
