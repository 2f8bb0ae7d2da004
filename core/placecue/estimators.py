"""Which estimators a config may name by their dotted names: scikit-learn's, and what plugins allow.

A config or a model folder is data, so it must not make placecue import, call, read or write
whatever it names: there is a list of modules, and what parameters may be set to is checked
(:mod:`placecue.estimator_parameters`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import Any

from sklearn.base import BaseEstimator, ClassifierMixin, is_classifier

from placecue.errors import UsageError, choices
from placecue.estimator_parameters import COMPOSED, checked

#: Where scikit-learn keeps its estimators. ``feature_extraction`` reads files named by samples.
SKLEARN = tuple(
    f"sklearn.{name}"
    for name in (
        "calibration", "cluster", "compose", "covariance", "cross_decomposition", "decomposition",
        "discriminant_analysis", "dummy", "ensemble", "feature_selection", "gaussian_process",
        "impute", "isotonic", "kernel_approximation", "kernel_ridge", "linear_model", "manifold",
        "mixture", "model_selection", "multiclass", "multioutput", "naive_bayes", "neighbors",
        "neural_network", "pipeline", "preprocessing", "random_projection", "semi_supervised",
        "svm", "tree",
    )
)  # fmt: skip
#: By module, the parameters whose text a plugin vouches for.
_allowed: dict[str, frozenset[str]] = dict.fromkeys(SKLEARN, frozenset())
#: How deep estimators may stand inside one another.
_DEPTH = 8


def allow_estimators(module: str, texts: Iterable[str] = ()) -> None:
    """Let configs and model folders name the estimators of another module, such as ``lightgbm``.

    A plugin calls it when it is loaded. The plugin vouches for three things, because a config or a
    model folder may come from anybody: that importing the module, and calling the constructors of
    its estimators with numbers, is harmless; that no number is more than a number (an open file);
    and that the text of ``texts`` is looked up in a table, and never read as the name of a file,
    folder, module, function or address. Parameters that are called like files, caches, processes
    or verbosity (``memory``, ``n_jobs``, …) keep their defaults whatever is vouched for.

    Parameters
    ----------
    module : str
        The module that has the estimators as attributes; not those inside it.
    texts : iterable of str
        Names of parameters that may be set to text, such as ``objective``. The others take
        numbers, true or false, null, lists of these, and estimators; and what scikit-learn's
        ``_parameter_constraints`` of the class name.
    """
    _allowed[module] = frozenset(texts)


def estimator(name: str, parameters: Mapping[str, Any] | None = None) -> Any:
    """Build an estimator.

    Parameters
    ----------
    name : str
        Dotted name of its class, such as ``sklearn.ensemble.RandomForestClassifier``.
    parameters : mapping, optional
        Plain data; a mapping with ``estimator`` (a dotted name) and ``params`` is built first, at
        any depth, such as ``steps: [[scale, {estimator: sklearn.preprocessing.StandardScaler}]]``.

    Raises
    ------
    UsageError
        If there is no such estimator, its module is not allowed, or a parameter is refused.
    """
    return _built(name, parameters, _DEPTH)


def classifier(name: str, parameters: Mapping[str, Any] | None = None) -> Any:
    """Build an estimator that must be a classifier; see :func:`estimator`."""
    built = estimator(name, parameters)
    try:
        fits = is_classifier(built)
    except Exception as error:  # such as that of a wrapper around nothing
        raise UsageError(f"{name} refused its parameters: {error}") from error
    if not fits:
        raise UsageError(f"{name} is no classifier; {choices(name, _classifiers(name))}")
    return built


def _built(name: Any, parameters: Any, depth: int) -> Any:
    kind, texts = _class(name)
    if depth == 0:
        raise UsageError(f"{name} stands too deep inside other estimators: {_DEPTH} are allowed")
    if not isinstance(parameters, Mapping | None):
        raise UsageError(f"the params of {name} must be a mapping of its parameters")
    known = kind._get_param_names()
    built = {}
    for key, value in (parameters or {}).items():
        if key not in known:
            raise UsageError(f"{name} has no parameter '{key}'; {choices(str(key), known)}")
        built[key] = checked(kind, name, key, _nested(value, key in COMPOSED, depth), texts)
    try:
        return kind(**built)
    except Exception as error:  # a third party's constructor may raise anything
        raise UsageError(f"{name} refused its parameters: {error}") from error


def _nested(value: Any, composed: bool, depth: int) -> Any:
    """Return a parameter's value with the estimators in it built."""
    if isinstance(value, Mapping) and "estimator" in value:
        return _built(value["estimator"], value.get("params"), depth - 1)
    if composed and isinstance(value, list):
        return [_named(each, depth) for each in value]
    return value


def _named(value: Any, depth: int) -> tuple[Any, ...]:
    """Return [name, estimator] or [name, estimator, columns] as scikit-learn takes it."""
    parts = tuple(value) if isinstance(value, list) else ()
    if not 2 <= len(parts) <= 3 or not isinstance(parts[0], str) or not _columns(parts[2:]):
        raise UsageError(
            f"estimators stand in a list as [NAME, {{estimator: …, params: …}}], got {value!r:.80}"
        )
    built = _nested(parts[1], False, depth)
    if not hasattr(built, "get_params") and built not in ("drop", "passthrough"):
        raise UsageError(
            f"'{parts[0]}' must be an estimator {{estimator: NAME, params: {{…}}}}, 'drop' or "
            f"'passthrough', got {built!r:.80}"
        )
    return (parts[0], built, *parts[2:])


def _columns(parts: tuple[Any, ...]) -> bool:
    return all(isinstance(each, list) and all(type(i) is int for i in each) for each in parts)


def _class(name: Any) -> tuple[Any, frozenset[str]]:
    """Return an allowed class, and which of its parameters may be text."""
    module, _, attribute = str(name).rpartition(".")
    if module not in _allowed or attribute.startswith("_"):
        raise UsageError(
            f"'{name!s:.100}' is no estimator that a config may name: give the dotted name of one "
            "of scikit-learn, such as sklearn.ensemble.RandomForestClassifier, or of a module "
            f"that a plugin allows; {choices(module[:100], _allowed)}"
        )
    kind = vars(_imported(module, name)).get(attribute)
    if kind is None:
        raise UsageError(f"there is no {name}; {choices(str(name), _classifiers(name))}")
    package = module.partition(".")[0]
    if not _is_estimator(kind) or kind.__module__.partition(".")[0] != package:
        raise UsageError(f"{name} is no estimator; {choices(str(name), _classifiers(name))}")
    return kind, _allowed[module]


def _imported(module: str, name: Any) -> Any:
    try:
        return import_module(module)
    except Exception as error:
        raise UsageError(f"{name} cannot be imported: {error}") from error


def _is_estimator(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseEstimator)


def _classifiers(name: Any) -> list[str]:
    """Return the classifiers of the module that a name names."""
    module = str(name).rpartition(".")[0]
    return [
        f"{module}.{attribute}"
        for attribute, kind in vars(import_module(module)).items()
        if _is_estimator(kind) and issubclass(kind, ClassifierMixin)
    ]
