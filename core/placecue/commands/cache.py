"""``placecue cache``: shows the features that are kept between runs, and trims them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from placecue.commands import as_json, tables
from placecue.commands.features import at_least_0, cache_of
from placecue.errors import UsageError
from placecue.storage.cache_folder import DAY, Kept, contents, trim

WRITES = None
HEADINGS = ("log", "cue, version", "samples", "MB", "last used", "parameters")
_MEGA, _GIGA = 1e6, 1e9


def run(config: dict[str, Any]) -> None:
    """Trim the cache if that is asked for, and print what is in it."""
    folder, _ = cache_of(config)
    if folder is None:
        raise UsageError("there is no cache to look at: give cache.folder=PATH")
    trim_to, unused_days = (at_least_0(config[key], key) for key in ("trim_to", "unused_days"))
    if trim_to is not None or unused_days is not None:
        removed = trim(folder, None if trim_to is None else trim_to * _GIGA, unused_days)
        if not as_json.wanted(config):
            print(f"removed {removed / _MEGA:.1f} MB")
    kept = contents(folder)
    if as_json.wanted(config):
        rows = [dict(zip(HEADINGS, row, strict=True)) for row in _rows(kept)]
        as_json.tell({"folder": folder, "bytes": sum(each.size for each in kept), "kept": rows})
        return
    if kept:
        tables.table(HEADINGS, _rows(kept))
    total = sum(each.size for each in kept)
    print(f"{folder}: {total / _MEGA:.1f} MB")


def _rows(kept: Sequence[Kept]) -> Iterator[list[str]]:
    """Yield a row for each log and cue; what a cue has learned fold by fold is counted."""
    alike: dict[tuple[str, str, str], list[Kept]] = {}
    for each in kept:
        alike.setdefault(_kind(each), []).append(each)
    for (log, cue, parameters), of_kind in alike.items():
        times = f"{len(of_kind)} x " if len(of_kind) > 1 else ""
        samples = "" if _learned(of_kind[0]) else f"{max(each.samples for each in of_kind)}"
        size = f"{sum(each.size for each in of_kind) / _MEGA:.1f}"
        used = _ago(max(each.used for each in of_kind))
        yield [log, cue, f"{times}{samples}".rstrip(), size, used, parameters]


def _kind(kept: Kept) -> tuple[str, str, str]:
    about = kept.about
    what = "what it learned" if _learned(kept) else about.get("altered")
    cue = f"{about.get('cue')} {about.get('version')}" + (f", {what}" if what else "")
    return "" if _learned(kept) else str(about.get("log")), cue, _parameters(about)


def _learned(kept: Kept) -> bool:
    return "seen" in kept.about


def _parameters(about: Mapping[str, Any]) -> str:
    changed = about.get("changed")
    if not isinstance(changed, dict) or not changed:
        return "by default"
    return ", ".join(f"{name}={value}" for name, value in sorted(changed.items()))


def _ago(used: float) -> str:
    days = (time.time() - used) / DAY
    return "today" if days < 1 else f"{days:.0f} days ago"
