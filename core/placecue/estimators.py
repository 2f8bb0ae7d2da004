"""Which estimators a config may name by their dotted names: scikit-learn's, and what plugins allow.

A config or a model folder is data, so it must not make placecue import and call whatever it names.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from sklearn.base import BaseEstimator, is_classifier
from sklearn.utils import all_estimators

from placecue.errors import UsageError, choices

_allowed: dict[str, None] = {"sklearn": None}


def allow_estimators(package: str) -> None:
    """Let configs name the estimators of another package, for example ``lightgbm``.

    A plugin calls it when it is loaded.
    """
    _allowed[package] = None


def estimator(name: str, parameters: Mapping[str, Any] | None = None) -> Any:
    """Build an estimator.

    Parameters
    ----------
    name : str
        Dotted name of its class, such as ``sklearn.ensemble.RandomForestClassifier``.
    parameters : mapping, optional
        Plain data; a mapping with ``estimator`` (a dotted name) and ``params`` is built first.

    Raises
    ------
    UsageError
        If there is no such estimator, its package is not allowed, or it refuses a parameter.
    """
    kind = _class(name)
    known = kind._get_param_names()
    built = {}
    for key, value in (parameters or {}).items():
        if key not in known:
            raise UsageError(f"{name} has no parameter '{key}'; {choices(key, known)}")
        nested = isinstance(value, Mapping) and "estimator" in value
        built[key] = estimator(value["estimator"], value.get("params")) if nested else value
    try:
        return kind(**built)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} refused its parameters: {error}") from error


def classifier(name: str, parameters: Mapping[str, Any] | None = None) -> Any:
    """Build an estimator that must be a classifier; see :func:`estimator`."""
    built = estimator(name, parameters)
    if not is_classifier(built):
        raise UsageError(f"{name} is no classifier; {choices(name, _classifiers())}")
    return built


def _class(name: str) -> Any:
    module, _, attribute = name.rpartition(".")
    package = module.partition(".")[0]
    if package not in _allowed or attribute.startswith("_"):
        raise UsageError(
            f"'{name}' is no estimator that a config may name: give the dotted name of one of "
            f"{', '.join(_allowed)}, such as sklearn.ensemble.RandomForestClassifier"
        )
    try:
        kind = getattr(import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise UsageError(f"there is no {name}; {choices(name, _classifiers())}") from error
    if not (isinstance(kind, type) and issubclass(kind, BaseEstimator)):
        raise UsageError(f"{name} is no estimator; {choices(name, _classifiers())}")
    if kind.__module__.partition(".")[0] not in _allowed:
        raise UsageError(f"{name} is of the package {kind.__module__}, which is not allowed")
    return kind


def _classifiers() -> list[str]:
    return [
        f"{kind.__module__.rpartition('._')[0] or kind.__module__}.{name}"
        for name, kind in all_estimators("classifier")
    ]
