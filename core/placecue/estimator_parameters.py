"""Which values a config may give to the parameters of an estimator: plain data that stays data.

A parameter can name a folder whose files are unpickled, a function, or a number of processes. So
nothing is allowed that is not known to be harmless: what a parameter takes is read from the
``_parameter_constraints`` of scikit-learn's classes (a list of alternatives for each parameter),
and alternatives that are callables, free text or objects do not count.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Collection, Mapping
from numbers import Integral, Number, Real
from typing import Any

from placecue.errors import UsageError

#: Parameters that only keep their default: files, processes, talk, and settings of other objects.
_REFUSED = re.compile(
    r"memory.*|.*cache(?!_size).*|n_jobs|.*threads?|nthread|.*thread_count|verbos.*|silent|"
    r"pre_dispatch|param_.*|.*(path|file|folder|dir|url|uri|callbacks?|client|device|logger)s?",
    re.IGNORECASE,
)
#: Parameters of scikit-learn whose free text is a word: a label, or a name looked up in a table.
_WORDS = frozenset({"constant", "outlier_label", "pos_label", "scoring", "threshold"})
#: Parameters of scikit-learn that take a mapping of numbers.
_MAPPINGS = frozenset(
    {"class_weight", "kernel_params", "metric_params", "monotonic_cst", "transformer_weights"}
)
#: Parameters that take a list of [name, estimator] or [name, estimator, columns].
COMPOSED = frozenset({"steps", "estimators", "transformers"})

_NO_VALIDATION = "no_validation"
_BY_WORD: dict[str, Callable[[Any], bool]] = {
    "array-like": lambda value: isinstance(value, (list, tuple)) and is_data(value),
    "boolean": lambda value: isinstance(value, bool),
    "cv_object": lambda value: _whole(value) or value is None,
    "nan": lambda value: isinstance(value, float) and math.isnan(value),
    "random_state": lambda value: _whole(value) or value is None,
}


def checked(kind: Any, name: str, parameter: str, value: Any, texts: Collection[str] = ()) -> Any:
    """Return a value as a parameter takes it, once it is known to be plain data that stays data.

    Parameters
    ----------
    kind : class
        The estimator.
    name : str
        What the config calls it.
    parameter : str
        One of its parameters.
    value : object
        Plain data, or an estimator that was built and checked.
    texts : collection of str
        Parameters of which a plugin vouches that their text is a word and no more.

    Raises
    ------
    UsageError
        If the parameter may not be set, or not to this.
    """
    if _is_default(kind, parameter, value):
        return value
    if _REFUSED.fullmatch(parameter):
        raise UsageError(
            f"{name}: '{parameter}' may not be set in a config or a model, which are data: it can "
            "name files, processes, functions or parameters of other objects; leave it out"
        )
    constraints = getattr(kind, "_parameter_constraints", {}).get(parameter)
    value = _as_tuple(value, constraints)
    taken = is_data(value) if parameter in texts else _takes(kind, parameter, value, constraints)
    if isinstance(value, Mapping) and parameter == "class_weight":  # JSON has no numbers as keys
        value = {int(k) if str(k).isdecimal() else k: weight for k, weight in value.items()}
    if not taken:
        raise UsageError(
            f"{name}: '{parameter}' cannot be {_shown(value)}: give it numbers, true or false, "
            "null, one of its known words, or an estimator as {estimator: NAME, params: {...}}"
        )
    return value


def is_data(value: Any) -> bool:
    """Tell whether a value is a number, truth value, text, null, or lists of them."""
    if isinstance(value, (list, tuple)):
        return all(map(is_data, value))
    return value is None or isinstance(value, (bool, int, float, str))


def _takes(kind: Any, parameter: str, value: Any, constraints: Any) -> bool:
    if constraints is None:  # sklearn's own are all known; a third party may say nothing
        return not kind.__module__.startswith("sklearn.") and _harmless(value)
    if constraints == _NO_VALIDATION:
        return _is_number(value) or value is None
    return any(_alternative(each, parameter, value) for each in constraints)


def _alternative(constraint: Any, parameter: str, value: Any) -> bool:
    """Tell whether a value fits one alternative, if that is one of plain data or an estimator."""
    if constraint is None:
        return value is None
    if isinstance(constraint, str):
        return constraint in _BY_WORD and _BY_WORD[constraint](value)
    if isinstance(constraint, type):
        return _of_type(constraint, parameter, value)
    if hasattr(constraint, "constraint"):  # one that scikit-learn does not show to people
        return _alternative(constraint.constraint, parameter, value)
    judge = getattr(constraint, "is_satisfied_by", None)
    plain = not isinstance(value, (Mapping, list, tuple))
    return judge is not None and plain and bool(judge(value))


def _of_type(kind: type, parameter: str, value: Any) -> bool:
    if kind is str:
        return isinstance(value, str) and parameter in _WORDS
    if kind in (list, tuple):
        composed = parameter in COMPOSED and isinstance(value, list)
        return composed or (isinstance(value, kind) and is_data(value))
    if issubclass(kind, Mapping):
        return parameter in _MAPPINGS and isinstance(value, Mapping) and _numbers(value)
    if kind in (Integral, Real, int, float):
        return isinstance(value, kind) and not isinstance(value, bool)
    return hasattr(value, "get_params") and isinstance(value, kind)


def _harmless(value: Any) -> bool:
    """Tell whether a value is numbers or an estimator: what nobody need vouch for."""
    if isinstance(value, (list, tuple)):
        return all(_harmless(each) for each in value if not hasattr(each, "get_params"))
    return value is None or _is_number(value) or hasattr(value, "get_params")


def _numbers(value: Mapping[str, Any]) -> bool:
    return all(
        isinstance(key, (str, int, float))
        and not _REFUSED.fullmatch(str(key))
        and (_is_number(each) or (isinstance(each, list) and all(map(_is_number, each))))
        for key, each in value.items()
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, Number)


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _as_tuple(value: Any, constraints: Any) -> Any:
    """Return a list as a tuple where only that is taken; JSON and YAML know lists alone."""
    only_tuples = isinstance(constraints, list) and tuple in constraints and list not in constraints
    return tuple(value) if only_tuples and isinstance(value, list) else value


def _is_default(kind: Any, parameter: str, value: Any) -> bool:
    default = inspect.signature(kind).parameters[parameter].default
    return type(value) is type(default) and is_data(value) and bool(value == default)


def _shown(value: Any) -> str:
    shown = repr(value)
    return shown if len(shown) <= 80 else f"{shown[:77]}..."
