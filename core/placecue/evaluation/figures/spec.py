"""What an experiment's config asks to be drawn."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from placecue.errors import UsageError, choices
from placecue.evaluation.results.about import About
from placecue.evaluation.results.results import Results
from placecue.evaluation.statistics import ALTERNATIVES

#: What every kind takes; a kind may take more.
COMMON = frozenset({"name", "kind", "title", "methods", "experiments", "names"})


def _a_text(value: Any) -> bool:
    return isinstance(value, str)


def _texts(value: Any) -> bool:
    return isinstance(value, Sequence) and not _a_text(value) and all(map(_a_text, value))


def _a_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _names(value: Any) -> bool:
    return isinstance(value, Mapping) and _texts([*value, *value.values()])


#: What the value of each key is to be, and how that is said; else it is a text.
SHAPES: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "methods": (_texts, "a list of methods"),
    "experiments": (_texts, "a list of experiments"),
    "names": (_names, "names by method"),
    "bottom": (lambda v: _a_number(v) and v < 100, "a number under 100"),
    "alpha": (lambda v: _a_number(v) and 0 < v < 1, "a number between 0 and 1"),
    "alternative": (lambda v: v in ALTERNATIVES, f"one of {', '.join(ALTERNATIVES)}"),
    "groups": (lambda v: isinstance(v, Mapping) and all(map(_names, v.values())),
               "by group the methods by the name of their bar"),
    "pairs": (lambda v: isinstance(v, Sequence) and all(_texts(e) and len(e) == 2 for e in v),
              "a list of two methods each"),
}  # fmt: skip


@dataclass(frozen=True)
class Spec:
    """A figure or table that is asked for, of what there is.

    Parameters
    ----------
    name : str
        Such as ``Figure 7``.
    kind : str
        Of :data:`placecue.evaluation.figures.make.KINDS`.
    title : str
        A heading; may be empty.
    methods, experiments : sequence of str
        Those that are drawn; only such as have results.
    names : mapping of str to str
        What methods are called in the figure, where it is not their name.
    options : mapping
        What the kind takes more.
    warnings : tuple of str
        What was asked for, and has no result.
    """

    name: str
    kind: str
    title: str
    methods: Sequence[str]
    experiments: Sequence[str]
    names: Mapping[str, str] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def label(self, method: str) -> str:
        """Return what a method is called in the figure."""
        return self.names.get(method, method)

    @property
    def heading(self) -> str:
        """The name, and the title if there is one."""
        return f"{self.name}. {self.title}" if self.title else self.name


def checked(told: Mapping[str, Any], keys: Collection[str], about: About) -> None:
    """Refuse what cannot be drawn whatever the results.

    Parameters
    ----------
    told : mapping
        As the config has it, with a name and a known kind.
    keys : collection of str
        What its kind takes.
    about : About
        Which methods and experiments there are.

    Raises
    ------
    UsageError
        If a key, a method or an experiment is unknown, or a value is not what it is to be.
    """
    name = told["name"]
    _known(told, keys, f"'{name}' takes no", f"kind '{told['kind']}'")
    for key, value in told.items():
        fits, shape = SHAPES.get(key, (_a_text, "a text"))
        if value is not None and not fits(value):
            raise UsageError(f"'{name}': {key} is to be {shape}, here it is {value!r}")
    for key in ("groups", "pairs"):
        if told.get(key) and told.get("methods"):
            raise UsageError(f"'{name}': {key} name the methods already, leave methods out")
    _known(asked_methods(told), about.methods, f"'{name}' names an unknown method", "methods")
    _known(told.get("experiments") or (), about.experiments,
           f"'{name}' names an unknown experiment", "experiments")  # fmt: skip
    labels = [(told.get("names") or {}).get(method, method) for method in about.methods]
    twice = sorted({label for label in labels if labels.count(label) > 1})
    if twice:
        raise UsageError(f"'{name}': names call two methods '{twice[0]}', give each its own")


def read(told: Mapping[str, Any], results: Results, about: About) -> Spec:
    """Return what is asked for, as far as there are results.

    Parameters
    ----------
    told : mapping
        As the config has it; it has been checked.
    results : Results
        What there is.
    about : About
        The methods and experiments, in the order in which they are shown.
    """
    methods = asked_methods(told) or list(about.methods)
    experiments = list(told.get("experiments") or about.experiments)
    there = {each.method for each in results if not each.error}
    tried = {each.pair.experiment for each in results if not each.error}
    listed = bool(asked_methods(told) or told.get("experiments"))
    wanted = [*((each, there) for each in methods), *((each, tried) for each in experiments)]
    missing = [
        f"{told['name']}: no results of '{each}' yet, drawn without it"
        for each, known in wanted
        if listed and each not in known
    ]
    return Spec(
        told["name"],
        told["kind"],
        told.get("title") or "",
        [each for each in methods if each in there],
        [each for each in experiments if each in tried],
        told.get("names") or {},
        {key: value for key, value in told.items() if key not in COMMON},
        tuple(missing),
    )


def asked_methods(told: Mapping[str, Any]) -> list[str]:
    """Return the methods that a spec names, wherever it does."""
    named = list(told.get("methods") or ())
    for bars in (told.get("groups") or {}).values():
        named += bars.values()
    for pair in told.get("pairs") or ():
        named += pair
    return list(dict.fromkeys(named))


def of_methods(
    specs: Iterable[Mapping[str, Any]], there: Collection[str]
) -> list[Mapping[str, Any]]:
    """Return what is asked for, of some methods only; what names none of them is left out."""
    return [
        _of_methods(told, there)
        for told in specs
        if not asked_methods(told) or set(asked_methods(told)) & set(there)
    ]


def _of_methods(told: Mapping[str, Any], there: Collection[str]) -> Mapping[str, Any]:
    made = dict(told)
    if told.get("methods"):
        made["methods"] = [each for each in told["methods"] if each in there]
    if told.get("names"):
        made["names"] = {key: each for key, each in told["names"].items() if key in there}
    if told.get("groups"):
        groups = {
            name: {bar: each for bar, each in bars.items() if each in there}
            for name, bars in told["groups"].items()
        }
        made["groups"] = {name: bars for name, bars in groups.items() if bars}
    if told.get("pairs"):
        made["pairs"] = [pair for pair in told["pairs"] if set(pair) <= set(there)]
    return made


def _known(asked: Iterable[str], there: Collection[str], complaint: str, what: str) -> None:
    for each in asked:
        if each not in there:
            raise UsageError(f"{complaint} '{each}' ({what}); {choices(str(each), there)}")
