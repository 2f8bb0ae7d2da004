"""``placecue cache``: shows the features that are kept between runs, and trims them."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from placecue.commands import tables
from placecue.commands.features import at_least_0, cache_of
from placecue.errors import UsageError
from placecue.storage.cache_folder import DAY, Kept, contents, trim

OUT_IS_FOLDER = False
_MEGA, _GIGA = 1e6, 1e9


def run(config: dict[str, Any]) -> None:
    """Trim the cache if that is asked for, and print what is in it."""
    folder, _ = cache_of(config)
    if folder is None:
        raise UsageError("there is no cache to look at: give cache.folder=PATH")
    trim_to, unused_days = (at_least_0(config[key], key) for key in ("trim_to", "unused_days"))
    if trim_to is not None or unused_days is not None:
        removed = trim(folder, None if trim_to is None else trim_to * _GIGA, unused_days)
        print(f"removed {removed / _MEGA:.1f} MB")
    kept = contents(folder)
    if kept:
        tables.table(
            ["log", "cue, version", "samples", "MB", "last used", "parameters"], map(_row, kept)
        )
    total = sum(each.size for each in kept)
    print(f"{folder}: {total / _MEGA:.1f} MB")


def _row(kept: Kept) -> list[str]:
    about = kept.about
    learned = "seen" in about
    what = "what it learned" if learned else about.get("altered")
    cue = f"{about.get('cue')} {about.get('version')}" + (f", {what}" if what else "")
    samples = "" if learned else str(kept.samples)
    size = f"{kept.size / _MEGA:.1f}"
    return [str(about.get("log")), cue, samples, size, _ago(kept.used), _parameters(about)]


def _parameters(about: Mapping[str, Any]) -> str:
    changed = about.get("changed")
    if not isinstance(changed, dict) or not changed:
        return "by default"
    return ", ".join(f"{name}={value}" for name, value in sorted(changed.items()))


def _ago(used: float) -> str:
    days = (time.time() - used) / DAY
    return "today" if days < 1 else f"{days:.0f} days ago"
