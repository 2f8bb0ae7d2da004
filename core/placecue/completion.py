"""Tab completion: the commands are ours, files and lists too; all else is Hydra's."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

from placecue.commands.help.examples import GROUPS
from placecue.commands.names import COMMANDS
from placecue.errors import UsageError

#: The last part of keys whose values are paths.
PATH_KEYS = frozenset((
    "log", "integration_log", "model", "out", "path", "labels", "rooms", "folder", "root", "logs",
    "merge", "poses", "scans", "odometry",
))  # fmt: skip
SHELLS = ("bash", "fish")


def complete(words: list[str]) -> int:
    """Answer ``-sc install=SHELL``, ``-sc uninstall=SHELL`` and ``-sc query=SHELL``.

    Parameters
    ----------
    words : list of str
        What stands after ``-sc``.

    Returns
    -------
    int
        The exit status.

    Raises
    ------
    UsageError
        If the request is none of the three, or for an unknown shell.
    """
    request, _, shell = (words[0] if words else "").partition("=")
    if request not in ("install", "uninstall", "query") or shell not in SHELLS:
        raise UsageError(
            "tab completion takes -sc install=SHELL or -sc uninstall=SHELL with SHELL one of "
            f"{', '.join(SHELLS)}, got '{' '.join(words)}'"
        )
    if request != "query":
        return _hydra("train", f"{request}={shell}")
    return _query(shell)


def offered(word: str) -> list[str]:
    """Return what completes a word besides keys and single options: files, and lists.

    Parameters
    ----------
    word : str
        What was typed so far of it, such as ``log=ru``, ``log=[a.mcap,b`` or ``cue=[crfh,``.
    """
    key, equals, value = word.partition("=")
    if not equals:
        return [] if word.startswith(("-", "+", "~")) else files(word)
    start, begun = _parted(value)
    if key.rpartition(".")[2] in PATH_KEYS:
        return [f"{key}={start}{each}" for each in files(begun)]
    if key in GROUPS and start:
        listed = re.split(r"[\[,]", start)
        names = [each for each in _options(key) if each.startswith(begun)]
        return [f"{key}={start}{each}" for each in names if each not in listed]
    return []


def files(begun: str) -> list[str]:
    """Return the files and folders whose path begins so; folders end in a slash."""
    folder, _, name = begun.rpartition("/")
    above = f"{folder}/" if "/" in begun else ""
    try:
        entries = sorted(Path(above or ".").expanduser().iterdir())
    except (OSError, RuntimeError):  # no such folder, or no home
        return []
    return [
        f"{above}{each.name}{'/' if each.is_dir() else ''}"
        for each in entries
        if each.name.startswith(name) and " " not in each.name
        and (name.startswith(".") or not each.name.startswith("."))
    ]  # fmt: skip


def _parted(value: str) -> tuple[str, str]:
    """Return the items of a list that are complete, with what opens it, and the one begun."""
    end = max(value.rfind("["), value.rfind(",")) + 1
    return value[:end], value[end:]


def _options(group: str) -> list[str]:
    from placecue.commands.help.notes import names_in
    from placecue.commands.help.page import BUILT_IN
    from placecue.components.hooks import KINDS
    from placecue.components.manager import current_plugins

    plugins = current_plugins()
    found = names_in(group, [BUILT_IN, *plugins.config_paths])
    return sorted(found.union(plugins.registry.names(group) if group in KINDS else ()))


def _query(shell: str) -> int:
    line = os.environ.get("COMP_LINE", "").replace(" --no-plugins ", " ")
    typed = line.split()
    if len(typed) < 2 or (len(typed) == 2 and not line.endswith(" ")):
        start = typed[1] if len(typed) == 2 else ""
        print(" ".join(command for command in COMMANDS if command.startswith(start)))
        return 0
    if typed[1] not in COMMANDS:
        return 0
    word = "" if line.endswith(" ") else typed[-1]
    own = offered(word) if len(typed) > 2 or word == "" else []
    if own:
        print("\n".join(own))
    if "=" in word and own:
        return 0
    # Hydra knows of one application without commands: leave the command out of the line.
    _, _, after = line.lstrip().removeprefix(typed[0]).partition(typed[1])
    os.environ["COMP_LINE"] = f"{typed[0]}{after}"
    os.environ["COMP_POINT"] = str(len(os.environ["COMP_LINE"]))
    return _hydra(typed[1], f"query={shell}")


def _hydra(command: str, request: str) -> int:
    from placecue.hydra_run import run_command

    executable = sys.argv[0]
    try:
        return run_command(command, ["-sc", request])
    finally:
        sys.argv[0] = executable
