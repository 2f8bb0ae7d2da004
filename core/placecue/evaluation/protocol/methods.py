"""The methods of an experiment: single-cue models, and what joins them, each chosen by words."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from itertools import product
from typing import Any

from placecue.errors import UsageError, choices

#: Composes the config of ``placecue train`` from words.
Compose = Callable[[Sequence[str]], Mapping[str, Any]]


@dataclass(frozen=True)
class SingleCue:
    """A single-cue model: a cue and its classifier.

    Parameters
    ----------
    name : str
        What methods call it.
    words : str
        What chooses it, as after ``placecue train``.
    cue, classifier : mapping
        Their configs.
    """

    name: str
    words: str
    cue: Mapping[str, Any] = field(repr=False)
    classifier: Mapping[str, Any] = field(repr=False)


@dataclass(frozen=True)
class Joined:
    """Several single-cue models, joined by an integrator.

    Parameters
    ----------
    name : str
        Of the method.
    models : tuple of str
        Names of single-cue models, in order of cost.
    words : str
        What chooses the integrator.
    integrator : mapping
        Its config.
    """

    name: str
    models: tuple[str, ...]
    words: str
    integrator: Mapping[str, Any] = field(repr=False)


@dataclass(frozen=True)
class Methods:
    """What is compared.

    Parameters
    ----------
    models : mapping of str to SingleCue
        Each of them is a method too.
    joined : mapping of str to Joined
    """

    models: Mapping[str, SingleCue]
    joined: Mapping[str, Joined]

    @property
    def names(self) -> list[str]:
        """All methods, single cues first."""
        return [*self.models, *self.joined]

    def only(self, patterns: Sequence[str]) -> Methods:
        """Return those whose name matches a pattern, such as ``CRFH*``, and the models they join.

        Raises
        ------
        UsageError
            If a pattern matches none.
        """
        for pattern in patterns:
            if not any(fnmatchcase(name, pattern) for name in self.names):
                raise UsageError(f"only: no method '{pattern}'; {choices(pattern, self.names)}")

        def wanted(name: str) -> bool:
            return any(fnmatchcase(name, pattern) for pattern in patterns)

        joined = {name: each for name, each in self.joined.items() if wanted(name)}
        needed = {model for each in joined.values() for model in each.models}
        models = {n: m for n, m in self.models.items() if n in needed or wanted(n)}
        return Methods(models, joined)


def methods_of(models: Any, methods: Any, compose: Compose) -> Methods:
    """Return the methods that a config asks for.

    Parameters
    ----------
    models : mapping
        By the name of each single-cue model its words, ``cue=crfh cues.crfh.bins=14``; or a
        mapping of ``words`` and ``for``, which fills in both name and words for every value of a
        list: ``{"crfh {m}": {words: "cue=crfh cues.crfh.classifier.multiclass={m}",
        for: {m: [oao, oaa]}}}``.
    methods : mapping
        By the name of each joined method a mapping of ``models``, ``integrator`` (words) and
        perhaps ``for``.
    compose : callable
        Composes the config of ``placecue train`` from words.

    Raises
    ------
    UsageError
        If something is none of that, or a method names no model.
    """
    singles: dict[str, SingleCue] = {}
    for name, spec in _filled(models, "models", "words"):
        _check_new(name, singles)
        singles[name] = _single(name, str(spec["words"]), compose)
    if not singles:
        raise UsageError("no method to evaluate: give cue=NAME, or models={NAME: WORDS}")
    joined: dict[str, Joined] = {}
    integrators: dict[str, Mapping[str, Any]] = {}
    for name, spec in _filled(methods, "methods", "integrator"):
        _check_new(name, {**singles, **joined})
        words = str(spec["integrator"])
        if words not in integrators:
            integrators[words] = _integrator(name, words, compose)
        joined[name] = Joined(name, _models(name, spec, singles), words, integrators[words])
    return Methods(singles, joined)


def _check_new(name: str, known: Collection[str]) -> None:
    if name in known:
        raise UsageError(
            f"two methods are called '{name}': give each a name of its own, with what 'for' lists "
            "in braces"
        )


def _filled(specs: Any, what: str, needed: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield names and specs, with what ``for`` lists filled in."""
    for name, spec in _a_mapping(specs or {}, what).items():
        spec = {"words": spec} if isinstance(spec, str) else dict(_a_mapping(spec, name))
        lists = _a_mapping(spec.pop("for", None) or {}, f"{name}.for")
        if needed not in spec:
            raise UsageError(f"{what}.{name} lacks {needed}: give words as after placecue train")
        for values in product(*(each if isinstance(each, list) else [each] for each in
                                lists.values())):  # fmt: skip
            given = dict(zip(lists, values, strict=True))
            yield _fill(str(name), given), {key: _fill(each, given) for key, each in spec.items()}


def _fill(value: Any, given: Mapping[str, Any]) -> Any:
    if isinstance(value, list):
        return [_fill(each, given) for each in value]
    if not given or not isinstance(value, str):
        return value
    try:
        return value.format(**given)
    except (LookupError, ValueError, AttributeError, TypeError) as error:
        raise UsageError(
            f"'{value}' cannot be filled in ({error}); {choices('', list(given))}"
        ) from error


def _a_mapping(value: Any, what: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise UsageError(f"{what} must be a mapping by name, got {value!r}")
    return value


def split(words: str, name: str) -> list[str]:
    """Return words as a shell reads them.

    Raises
    ------
    UsageError
        If a quote is not closed; ``name`` says whose words they are.
    """
    try:
        return shlex.split(words)
    except ValueError as error:
        raise UsageError(f"the words of '{name}' ({words}) make no sense: {error}") from error


def _single(name: str, words: str, compose: Compose) -> SingleCue:
    cues = compose([*split(words, name), "integrator=none"])["cues"]
    if len(cues) != 1:
        raise UsageError(
            f"model '{name}' ({words}) has {len(cues)} cues ({', '.join(cues)}): give one; "
            "methods join models"
        )
    [spec] = cues.values()
    cue = {key: value for key, value in spec.items() if key != "classifier"}
    return SingleCue(name, words, cue, spec["classifier"])


def _integrator(name: str, words: str, compose: Compose) -> Mapping[str, Any]:
    found = compose(split(words, name)).get("integrator")
    if not isinstance(found, Mapping):
        raise UsageError(f"method '{name}' ({words}) has no integrator: give integrator=NAME")
    return found


def _models(
    name: str, spec: Mapping[str, Any], singles: Mapping[str, SingleCue]
) -> tuple[str, ...]:
    models = spec.get("models")
    if not isinstance(models, list) or len(models) < 2:
        raise UsageError(f"method '{name}' must list two models or more, got {models!r}")
    for model in models:
        if model not in singles:
            raise UsageError(f"method '{name}': no model '{model}'; {choices(str(model), singles)}")
    return tuple(models)


def specs_of_words(
    cues: Sequence[str], integrators: Sequence[str], words: Sequence[str]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the models and methods that ``cue=[...] integrator=[...]`` ask for.

    Each cue alone, and all of them joined by each integrator.

    Parameters
    ----------
    cues, integrators : sequence of str
        Names of options.
    words : sequence of str
        Everything that was typed; words of a cue go to its model, ``cues.crfh.bins=14``, those of
        the integrator to every method.

    Returns
    -------
    tuple of dict
        For :func:`methods_of`.
    """
    models = {
        cue: shlex.join([f"cue={cue}", *_about(rf"cues\.{re.escape(cue)}", words)]) for cue in cues
    }
    methods = {
        " + ".join([*cues, name]): {
            "models": list(cues),
            "integrator": shlex.join([f"integrator={name}", *_about("integrator", words)]),
        }
        for name in (integrators if len(cues) > 1 else ())
    }
    return models, methods


def _about(place: str, words: Sequence[str]) -> list[str]:
    """Return the words that set something inside a place of the config."""
    inside = re.compile(rf"[+~]*(?:[\w/]+@)?{place}(?:\.|@)[^=]*=|[+~]*[\w/]+@{place}=")
    return [word for word in words if inside.match(word)]
