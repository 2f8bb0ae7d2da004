"""The one door through which components are called.

A component may do anything: raise, leave, return nonsense. What comes out of here is what was
promised, or one line that says whose fault it is.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import methodcaller
from typing import TYPE_CHECKING, Any, TypeAlias

from placecue.errors import ComponentError, ContractError, Interrupted, PlacecueError, told
from placecue.ownership import provenance

if TYPE_CHECKING:
    from placecue.observation import Observation

#: Returns what is wrong with a result, such as ``returned 1 row for 3 samples``, or None.
Check: TypeAlias = Callable[[Any], str | None]


def call(
    component: object,
    method: str,
    /,
    *arguments: Any,
    check: Check | None = None,
    at: Observation | str | None = None,
    **keywords: Any,
) -> Any:
    """Call a method of a component.

    Parameters
    ----------
    component : object
        A cue, kernel, classifier ...
    method : str
        Name of the method.
    *arguments, **keywords
        What to call it with.
    check : callable, optional
        Given the result, returns what is wrong with it or None; see :mod:`placecue.contracts`.
    at : Observation or str, optional
        Where in a log that is, for messages: an observation, or words such as ``at sample 3``.

    Returns
    -------
    object
        What the method returned.

    Raises
    ------
    PlacecueError
        As the component raised it.
    ComponentError
        If it raised anything else, or wanted to leave the process; the cause is chained.
    ContractError
        If ``check`` found something wrong.
    Interrupted
        On Ctrl-C; it names the component that was at work.
    """
    function = methodcaller(method, *arguments, **keywords)
    return step(component, method, function, component, check=check, at=at)


def step(
    component: object,
    doing: str,
    function: Callable[..., Any],
    /,
    *arguments: Any,
    check: Check | None = None,
    at: Observation | str | None = None,
) -> Any:
    """Call a function that runs a component's code, such as ``next`` over its iterator.

    Parameters
    ----------
    component : object
        Whose code it is.
    doing : str
        What it does, for messages, in place of a method's name.
    function : callable
        What to call.
    *arguments, check, at
        See :func:`call`, which raises the same.
    """
    try:
        result = function(*arguments)
        wrong = None if check is None else check(result)
    except (PlacecueError, Interrupted):
        raise
    except BaseException as error:
        raise _said(component, doing, at, error) from error
    if wrong is not None:
        raise ContractError(f"{provenance(component)}: {doing} {wrong}{_where(', ', at)}")
    return result


def _said(
    component: object, doing: str, at: Observation | str | None, error: BaseException
) -> ComponentError | Interrupted:
    """Return what a component raised as one line of ours."""
    who = provenance(component)
    if isinstance(error, KeyboardInterrupt):
        return Interrupted(f"interrupted in {doing} of {who}{_where(' ', at)}")
    return ComponentError(f"{who}: {doing} failed{_where(' ', at)}: {told(error)}")


def _where(before: str, at: Observation | str | None) -> str:
    if at is None:
        return ""
    if isinstance(at, str):
        return f"{before}{at}"
    return f"{before}at stamp {at.stamp}{f' of {at.log_name}' if at.log_name else ''}"
