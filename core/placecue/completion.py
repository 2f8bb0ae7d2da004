"""Tab completion: the commands are ours, what follows them is Hydra's."""

from __future__ import annotations

import os
import sys

from placecue.commands.names import COMMANDS
from placecue.errors import UsageError

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


def _query(shell: str) -> int:
    line = os.environ.get("COMP_LINE", "").replace(" --no-plugins ", " ")
    typed = line.split()
    if len(typed) < 2 or (len(typed) == 2 and not line.endswith(" ")):
        start = typed[1] if len(typed) == 2 else ""
        print(" ".join(command for command in COMMANDS if command.startswith(start)))
        return 0
    if typed[1] not in COMMANDS:
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
