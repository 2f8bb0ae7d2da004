"""The help of one command: use, examples, essentials, choices, and every other key by group."""

from __future__ import annotations

import re
import shutil
import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

from placecue.commands.help import notes
from placecue.commands.help.examples import EXAMPLES, GROUPS, USAGE
from placecue.commands.help.notes import Note, Option
from placecue.commands.names import COMMANDS
from placecue.components.hooks import KINDS
from placecue.components.manager import current_plugins

BUILT_IN = "pkg://placecue_conf"
#: Keys that come first.
ESSENTIAL = ("log", "model", "out", "path")
INDENT = 26


def page(command: str, words: Sequence[str] = ()) -> str:
    """Return the help of a command.

    Parameters
    ----------
    command : str
        Its name.
    words : sequence of str
        What else was typed: ``source=carmen`` shows the keys of that source.
    """
    roots = [BUILT_IN, *current_plugins().config_paths]
    primary = notes.find(command, roots) or Option()
    chosen = {**_chosen(primary.defaults), **_typed(words)}
    lines = [f"placecue {command} {USAGE.get(command, '')} [key=value ...]".replace("  ", " ")]
    lines += [COMMANDS[command], "", "examples:"]
    lines += [f"  {each}" for each in EXAMPLES.get(command, ())]
    own = [note for note in primary.notes if note.keys[0] in ESSENTIAL]
    rest = [note for note in primary.notes if note.keys[0] not in ESSENTIAL]
    lines += _section("essentials", own)
    lines += _groups(chosen, roots)
    sections = list[str]()
    for name in _settings(primary.defaults):
        option = notes.find(f"settings/{name}", roots) or Option()
        if option.notes and option.package in ("", "_global_") and len(option.notes) == 1:
            rest += option.notes
        else:
            sections += _section(name, option.notes, f"{option.package}.".replace("_global_.", ""))
    lines += [*_section("more", rest), *sections]
    for group, names in chosen.items():
        for name in names:
            lines += _component(group, name, roots)
    return "\n".join([*lines, "", *_last(command), ""])


def _last(command: str) -> list[str]:
    return [
        f"placecue {command} --cfg job        the whole config as composed",
        f"placecue {command} -m key=a,b       a sweep: one run for each value",
        f"placecue {command} --hydra-help     all of Hydra's options",
    ]


def _chosen(defaults: Sequence[Any]) -> dict[str, list[str]]:
    """Return the options that a config chooses, by group."""
    found: dict[str, list[str]] = {}
    for each in defaults:
        if isinstance(each, dict):
            for group, value in each.items():
                if group != "settings" and " " not in group:
                    listed = value if isinstance(value, list) else [value]
                    found[group] = [str(v) for v in listed if v not in (None, "???")]
    return found


def _settings(defaults: Sequence[Any]) -> list[str]:
    found: list[str] = []
    for each in defaults:
        value = each.get("settings", []) if isinstance(each, dict) else []
        found += value if isinstance(value, list) else [value]
    return [name for name in found if name != "placecue"]


def _typed(words: Sequence[str]) -> dict[str, list[str]]:
    found = {}
    for word in words:
        match = re.fullmatch(r"\+?(?P<group>\w+)=\[?(?P<names>[\w,]+)\]?", word)
        if match and match["group"] in GROUPS:
            found[match["group"]] = match["names"].split(",")
    return found


def _groups(chosen: dict[str, list[str]], roots: list[str]) -> Iterator[str]:
    if not chosen:
        return
    yield from ("", "choices, group=option:")
    registry = current_plugins().registry
    for group, names in chosen.items():
        available = notes.names_in(group, roots)
        if group in KINDS:
            available |= set(registry.names(group))
        given = names[0] if len(names) == 1 else f"[{','.join(names)}]" if names else ""
        text = f"{GROUPS.get(group, '')} Options: {', '.join(sorted(available))}."
        yield from _entry(f"{group}={given}", text.strip())


def _component(group: str, name: str, roots: list[str]) -> list[str]:
    option = notes.find(f"{group}/{name}", roots)
    if option is None or not option.notes:
        return []
    prefix = f"cues.{name}." if group == "cue" else f"{group}."
    if option.package == "_global_":
        prefix = ""
    inner = [note for note in option.notes if note.keys != ["path"]]
    title = option.title.rstrip(".").split(". ")[0]
    return _section(f"{group}={name}: {title}", inner, prefix)


def _section(title: str, entries: Sequence[Note], prefix: str = "") -> list[str]:
    if not entries:
        return []
    lines = ["", f"{title}:"]
    for note in entries:
        lines += _noted(note, prefix)
    return lines


def _noted(note: Note, prefix: str) -> Iterator[str]:
    if len(note.keys) == 1:
        value = note.values[0]
        shown = value not in ("", "null", "???", "${log}") and "${" not in value
        default = f" [{value}]" if shown else ""
        yield from _entry(f"{prefix}{note.keys[0]}", f"{note.text}{default}".strip())
        return
    names = ", ".join(f"{prefix}{key}" for key in note.keys)
    yield from _entry(names, note.text)


def _entry(head: str, text: str) -> Iterator[str]:
    width = min(shutil.get_terminal_size((96, 24)).columns, 110)
    wrapped = textwrap.wrap(text, max(width - INDENT, 30)) or [""]
    if len(head) > INDENT - 4:
        yield from textwrap.wrap(head, width, initial_indent="  ", subsequent_indent="  ")
    else:
        yield f"  {head:<{INDENT - 2}}{wrapped.pop(0)}".rstrip()
    yield from (" " * INDENT + line for line in wrapped if line)
