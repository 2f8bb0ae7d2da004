"""The command line: ``placecue COMMAND [Hydra overrides]``.

Heavy imports are late: help and errors of usage answer at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper

from placecue import interruption
from placecue.commands.names import COMMANDS, TRACEBACK
from placecue.errors import PlacecueError, UsageError, choices

HELP = """\
placecue: what kind of place a robot is in, from many cues.

usage: placecue COMMAND [key=value ...] [options]

commands:
{commands}

placecue COMMAND --help                       its options and their values
placecue train log=a.mcap cue=[crfh,laser] integrator=svm_das out=model
placecue COMMAND --cfg job                    the composed config, without running
placecue COMMAND -m key=value1,value2         a sweep: one run for each value
placecue --no-plugins COMMAND                 the built-in plugins alone
placecue --version
eval "$(placecue -sc install=bash)"           tab completion (or fish)
"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line.

    Exits with 0, 1 (data), 2 (usage), 130 (interrupted) or 141 (nobody reads on).
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a terminal of few letters must not end a run
            stream.reconfigure(errors="backslashreplace")
    if "--no-plugins" in words:
        words = [word for word in words if word != "--no-plugins"]
        os.environ["PLACECUE_NO_PLUGINS"] = "1"
    try:
        with interruption.ending_in_time():
            status = run(words)
        sys.stdout.flush()
    except BrokenPipeError:  # such as "placecue --help | head"
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 141
    if status == interruption.STATUS:
        interruption.end(status)
    sys.exit(status)


def run(words: list[str]) -> int:
    """Run one command line and return its exit status."""
    if not words or words[0] in ("-h", "--help", "help"):
        print(help_text())
        return 0
    if "--version" in words:
        from placecue import __version__

        print(f"placecue {__version__}")
        return 0
    try:
        if words[0] in ("-sc", "--shell_completion", "--shell-completion"):
            from placecue.completion import complete

            return complete(words[1:])
        command, overrides = words[0], words[1:]
        if command not in COMMANDS:
            raise UsageError(f"unknown command '{command}'; {choices(command, COMMANDS)}")
        return _command(command, overrides)
    except PlacecueError as error:
        return _failed(words, str(error), error.exit_status)
    except BrokenPipeError:
        raise
    except KeyboardInterrupt as error:
        return _failed(words, str(error) or "interrupted", interruption.STATUS)
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        return _failed(
            words,
            f"{words[0]} broke off, which should not happen ({reason}): {TRACEBACK}=1 before the "
            "command shows where, for a report",
            1,
        )


def _command(command: str, words: list[str]) -> int:
    """Show the help of a command, or run it; what it is about to read is told at once."""
    if {"-h", "--help"}.intersection(words):
        from placecue.commands.help.page import page

        print(page(command, words), end="")
        return 0
    from placecue.commands.words import prepared

    words = prepared(command, words)
    from placecue.hydra_run import run_command

    return run_command(command, words)


def _failed(words: Sequence[str], message: str, status: int) -> int:
    """Say what went wrong, in one line unless the traceback is wanted; return the status."""
    if wants_traceback(words):
        from traceback import print_exc

        print_exc()
    else:
        print(f"placecue: {message}", file=sys.stderr)
    return status


def help_text() -> str:
    """Return the help of the command line as a whole."""
    width = max(map(len, COMMANDS))
    return HELP.format(commands="\n".join(f"  {n:<{width}}  {s}" for n, s in COMMANDS.items()))


def wants_traceback(words: Sequence[str]) -> bool:
    """Tell whether errors should show the whole traceback."""
    return os.environ.get(TRACEBACK) == "1" or any(
        word.lower() in ("hydra.verbose=true", "hydra.verbose=1") for word in words
    )
