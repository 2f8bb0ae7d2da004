"""Everything placecue raises on purpose, under one base.

A message says in one line what was wrong, where, what was available and what to do. The command
line prints it as it is and exits with the class's ``exit_status``.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class PlacecueError(Exception):
    """Base of every error that placecue raises on purpose."""

    exit_status = 1


class UsageError(PlacecueError):
    """The request was wrong: an unknown name, parameter or topic, or a value that cannot be."""

    exit_status = 2


class DataError(PlacecueError):
    """The data were wrong: a file that is not a log, a log without labels, a broken model."""


class UnusableObservation(DataError):
    """One observation lacks, or spoils, a part that a cue requires. Others may be fine."""


class PluginError(UsageError):
    """A plugin could not be loaded, or two plugins claim one name."""


class ComponentError(PlacecueError):
    """A component failed: it raised what is no error of ours, or wanted to leave the process.

    At one observation it may be passed over like an unusable one, where that is asked for.
    """


class ContractError(ComponentError):
    """A component returned what its interface does not promise; nothing after it can be trusted."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C while a component was at work; says which."""


#: What foreign code may raise besides Ctrl-C; wanting to leave is an error like any other.
FOREIGN = (Exception, SystemExit, GeneratorExit)
#: So much of the text of a foreign error is told.
_TOLD = 400


def told(error: BaseException) -> str:
    """Return a foreign error in one line: its type, and its text as far as it has one."""
    try:
        text = " ".join(str(error).split())
    except Exception:  # its text is made by foreign code as well
        text = "(which has no text)"
    text = text if len(text) <= _TOLD else f"{text[:_TOLD]} ..."
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def described(value: object) -> str:
    """Return the type of a value with its article, such as ``a list``."""
    name = type(value).__name__
    return "None" if value is None else f"{'an' if name[0] in 'aeiouAEIOU' else 'a'} {name}"


def choices(wanted: str, available: Iterable[str]) -> str:
    """Describe what exists, with the nearest match first.

    Parameters
    ----------
    wanted : str
        The name that was not found.
    available : iterable of str
        The names that exist.

    Returns
    -------
    str
        For example ``did you mean 'crfh'? available: crfh, laser``.
    """
    names = sorted(available)
    listed = f"available: {', '.join(names) if names else 'none'}"
    near = get_close_matches(wanted, names, n=1, cutoff=0.5)
    return f"did you mean '{near[0]}'? {listed}" if near else listed
