"""Which recordings models are trained on, and which they are tested on.

An experiment is a splitter over recordings: every ordered pair, those that a rule on the
conditions picks, a list, one log left out in turn, or folds within each recording.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from placecue.errors import UsageError, choices
from placecue.evaluation.protocol.recordings import Recorded, check_names
from placecue.evaluation.results.result import Pair

#: What ``pairs`` may be beside a rule or a list.
WAYS = ("all", "leave_one_out", "folds")
#: The words of a rule.
RULE = ("same", "differ", "where", "way")


class Part(NamedTuple):
    """A recording, or the samples of it that a fold holds out, or all others.

    Parameters
    ----------
    recording : str
        Its name.
    fold : int or None
        The fold; None for the whole recording.
    held_out : bool
        Whether these are the samples that the fold holds out.
    """

    recording: str
    fold: int | None = None
    held_out: bool = False

    def __str__(self) -> str:
        if self.fold is None:
            return self.recording
        return f"{self.recording} {'fold' if self.held_out else 'without fold'} {self.fold + 1}"


class Split(NamedTuple):
    """A pair, in parts of recordings.

    Parameters
    ----------
    experiment, world : str
    train : tuple of Part
    test : Part
    """

    experiment: str
    world: str
    train: tuple[Part, ...]
    test: Part

    @property
    def pair(self) -> Pair:
        """The pair, by names."""
        return Pair(self.experiment, self.world, tuple(map(str, self.train)), str(self.test))


def splits_of(spec: Any, recordings: Sequence[Recorded], n_folds: int) -> list[Split]:
    """Return the splits of an experiment.

    Parameters
    ----------
    spec : str, mapping or list
        ``all``: every ordered pair of one world; ``leave_one_out``; ``folds``: folds within each
        recording; a rule: conditions that are the ``same`` or ``differ`` between the two, and
        ``where``, which both must have; ``way``, one of these words, among those that ``where``
        picks; a list of [train, test] by name, where train may be a
        list; or a mapping of names of experiments to such.
    recordings : sequence of Recorded
        With all metadata.
    n_folds : int
        How many folds each recording is cut into.

    Raises
    ------
    UsageError
        If it makes no sense, names no recording, or picks no pair.
    """
    named = _named(spec)
    found = []
    for name, each in named.items():
        of_name = [
            split
            for world in dict.fromkeys(recorded.world for recorded in recordings)
            for split in _of(name, each, [r for r in recordings if r.world == world], n_folds)
        ]
        if not of_name:
            raise UsageError(
                f"{name}: {_why_none(each, recordings)}; give other pairs, or more recordings"
            )
        found += of_name
    return found


def _named(spec: Any) -> dict[str, Any]:
    """Return what picks pairs by the name of each experiment."""
    if isinstance(spec, Mapping) and spec and not set(spec) & set(RULE):
        return {str(name): each for name, each in spec.items()}
    if isinstance(spec, str):
        return {spec.replace("_", " "): spec}
    return {"pairs": spec}


def _of(name: str, spec: Any, recordings: Sequence[Recorded], n_folds: int) -> Iterator[Split]:
    world, names = recordings[0].world, [each.name for each in recordings]
    if isinstance(spec, Mapping) and "way" in spec:
        there = [each for each in recordings if fits({"where": spec.get("where")}, each, each)]
        yield from _of(name, _way(spec), there, n_folds) if there else ()
        return
    if isinstance(spec, Mapping):
        found = (([a.name], b.name) for a, b in _ordered(recordings) if fits(spec, a, b))
    elif isinstance(spec, list):
        found = ((train, test) for train, test in _listed(spec, names))
    elif spec == "all":
        found = (([a.name], b.name) for a, b in _ordered(recordings))
    elif spec == "leave_one_out":
        tested = names if len(names) > 1 else []
        found = (([n for n in names if n != test], test) for test in tested)
    elif spec == "folds":
        for each in names:
            for fold in range(n_folds):
                yield Split(name, world, (Part(each, fold),), Part(each, fold, True))
        return
    else:
        raise UsageError(f"pairs must be a rule, a list, or a word; {choices(str(spec), WAYS)}")
    for train, test in found:
        yield Split(name, world, tuple(map(Part, train)), Part(test))


def _way(spec: Mapping[str, Any]) -> str:
    way, others = spec["way"], [key for key in spec if key not in ("way", "where")]
    if way not in WAYS or others:
        told = f"way: {way}" + "".join(f", {key}" for key in others)
        raise UsageError(
            f"pairs {{{told}}} make no sense: way is one of {', '.join(WAYS)}, and where= alone "
            "stands beside it"
        )
    return str(way)


def _ordered(recordings: Sequence[Recorded]) -> Iterator[tuple[Recorded, Recorded]]:
    return ((a, b) for a in recordings for b in recordings if a is not b)


def fits(rule: Mapping[str, Any], a: Recorded, b: Recorded) -> bool:
    """Tell whether two recordings are a pair by a rule.

    Raises
    ------
    UsageError
        If the rule is none, or asks for a condition that one of them does not tell.
    """
    if not isinstance(rule, Mapping):
        raise UsageError(f"a rule for pairs is a mapping, {{same: [CONDITION]}}, got {rule!r}")
    unknown = [key for key in rule if key not in RULE]
    if unknown:
        raise UsageError(f"a rule for pairs has no '{unknown[0]}'; {choices(unknown[0], RULE)}")
    if not isinstance(rule.get("where") or {}, Mapping):
        raise UsageError(f"where is a mapping, {{CONDITION: VALUE}}, got {rule['where']!r}")
    same, differ = _words(rule, "same"), _words(rule, "differ")
    where = {str(k): str(v) for k, v in (rule.get("where") or {}).items()}
    for each in (a, b):
        _check_told([*same, *differ, *where], each)
    return (
        all(a.metadata[key] == b.metadata[key] for key in same)
        and all(a.metadata[key] != b.metadata[key] for key in differ)
        and all(each.metadata[key] == value for key, value in where.items() for each in (a, b))
    )


def _words(rule: Mapping[str, Any], key: str) -> list[str]:
    words = rule.get(key) or []
    return [str(word) for word in ([words] if isinstance(words, str) else words)]


def _check_told(conditions: Sequence[str], recording: Recorded) -> None:
    for condition in conditions:
        if condition not in recording.metadata:
            told = ", ".join(recording.metadata) or "nothing"
            raise UsageError(
                f"pairs asks for '{condition}', which {recording.name} does not tell (it tells "
                f"{told}): give recordings={{NAME: {{log: FILE, {condition}: ...}}}}, or "
                "conditions.pattern, a pattern of names with named groups"
            )


def _listed(pairs: Sequence[Any], known: Sequence[str]) -> Iterator[tuple[list[str], str]]:
    for each in pairs:
        if not isinstance(each, (list, tuple)) or len(each) != 2:
            raise UsageError(f"a pair must be [train, test], got {each!r}")
        train = [str(n) for n in each[0]] if isinstance(each[0], list) else [str(each[0])]
        test = str(each[1])
        check_names([*train, test], known, f"pair [{' + '.join(train)}, {test}]")
        if not train or len(set(train)) < len(train):
            raise UsageError(
                f"pair [[{', '.join(train)}], {test}] trains on "
                f"{'one log twice' if train else 'nothing'}: list each log of its training once"
            )
        if test in train:
            raise UsageError(
                f"pair [{' + '.join(train)}, {test}] tests on what it trains on: give two logs"
            )
        yield train, test


def _why_none(spec: Any, recordings: Sequence[Recorded]) -> str:
    if len(recordings) == 1:
        return f"one recording ({recordings[0].name}) makes no pair of two"
    return f"no two of {len(recordings)} recordings are a pair by {spec}"


def partner_of(
    rule: Mapping[str, Any],
    recording: Recorded,
    recordings: Sequence[Recorded],
    but: Collection[str] = (),
) -> Recorded | None:
    """Return the first recording after one, in turn, that a rule pairs it with; None if none.

    Those named in ``but`` are passed over.
    """
    of_world = [each for each in recordings if each.world == recording.world]
    at = [each.name for each in of_world].index(recording.name)
    in_turn = of_world[at + 1 :] + of_world[:at]
    fitting = (each for each in in_turn if fits(rule, recording, each))
    return next((each for each in fitting if each.name not in but), None)
