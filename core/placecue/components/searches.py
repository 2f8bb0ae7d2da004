"""Overrides in words of ours: keys that an option does not show, and parts listed by name.

Hydra refuses a key that is not in the config unless it is forced with ``++``. Which parameters a
component can search is for the component to say, so here that is done for the user.

The parts of a cue made of cues are options of a group, so that each brings its parameters; they
are listed as any other value is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from omegaconf import DictConfig

from placecue.errors import UsageError, choices

#: The component, and which of its mappings takes keys of its own.
_KEY = re.compile(r"(?P<component>[\w.]+)\.(search|params)\.[^=\s]+=")
#: The parts of a cue, listed by their names; several lists in a sweep.
_PARTS = re.compile(r"(?P<parts>cues\.\w+\.parts)=(?P<listed>[\w\s,]*|\[[\w\s,\[\]]*\])")


def opened(overrides: Sequence[str]) -> list[str]:
    """Return overrides that may add keys to ``search`` and ``params``, whatever is there.

    What lists the parts of a cue by their names chooses them, ``parts@cues.NAME.parts=[...]``.

    Raises
    ------
    UsageError
        If it lists a part twice.
    """
    return [_opened(each) for each in overrides]


def _opened(override: str) -> str:
    if _KEY.match(override):
        return f"++{override}"
    found = _PARTS.fullmatch(override)
    if found is None or found["listed"].strip() in ("", "null"):
        return override
    for some in re.findall(r"\[([^\[\]]*)\]", found["listed"]):
        names = [each.strip() for each in some.split(",")]
        twice = [each for each in names if names.count(each) > 1]
        if twice:
            raise UsageError(f"{override}: '{twice[0]}' is listed twice; a part is one cue")
    return f"parts@{found['parts']}={found['listed']}"


def check_opened(config: DictConfig, overrides: Sequence[str]) -> None:
    """Check that what :func:`opened` forced belongs to a component.

    Raises
    ------
    UsageError
        If there is no component where an override puts a key of ``search`` or ``params``.
    """
    for override in overrides:
        found = _KEY.match(override.removeprefix("++"))
        if found is None:
            continue
        known = list(_components(config))
        component = found["component"]
        # The params of an estimator hold estimators with params of their own.
        if not any(component == each or component.startswith(f"{each}.params.") for each in known):
            raise UsageError(
                f"{override.removeprefix('++')}: there is no component {component}; "
                f"{choices(component, known)}"
            )


def _components(config: DictConfig, where: str = "") -> Iterator[str]:
    for key, value in config.items_ex(resolve=False):
        place = f"{where}{key!s}"
        if isinstance(value, DictConfig) and not (value._is_none() or value._is_missing()):
            if "plugin" in value:
                yield place
            yield from _components(value, f"{place}.")
