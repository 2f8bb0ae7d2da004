"""The results of a run folder, and of several put together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from placecue.errors import DataError, UsageError
from placecue.evaluation.results.about import About
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.store import ResultStore


def kept(folder: Path) -> tuple[About, Results]:
    """Return what was evaluated into a folder, and its results.

    Raises
    ------
    DataError
        If there is nothing of the kind, or no result is there yet.
    """
    about, store = About.load(folder), ResultStore(folder)
    found = [store.load(digest) for digest in about.digests if digest in store]
    if not found:
        raise DataError(f"{folder} holds no result yet: run placecue evaluate out={folder}")
    return about, Results([*found, *failures(about)])


def failures(about: About) -> list[Result]:
    """Return the results of a run that came to nothing."""
    return [
        Result.failed(_pair(each["pair"]), each["method"], each["error"]) for each in about.failures
    ]


def merged(folders: Sequence[Path]) -> tuple[About, Results]:
    """Return what was evaluated into several folders, as one.

    Raises
    ------
    UsageError
        If two folders have a result of the same method and pair.
    """
    parts = [kept(folder) for folder in folders]
    [about, *others] = [each for each, _ in parts]
    for other in others:
        about = replace(
            about,
            recordings={**about.recordings, **other.recordings},
            methods={**about.methods, **other.methods},
            experiments={
                name: about.experiments.get(name, 0) + other.experiments.get(name, 0)
                for name in dict.fromkeys([*about.experiments, *other.experiments])
            },
            digests=[*about.digests, *other.digests],
            areas=[*about.areas, *other.areas],
            seconds={
                step: about.seconds.get(step, 0) + other.seconds.get(step, 0)
                for step in dict.fromkeys([*about.seconds, *other.seconds])
            },
            warnings=[*about.warnings, *other.warnings],
            failures=[*about.failures, *other.failures],
            command=f"{about.command}; {other.command}",
        )
    results: dict[tuple[str, Pair], Result] = {}
    for folder, (_, of_folder) in zip(folders, parts, strict=True):
        for result in of_folder:
            if (result.method, result.pair) in results:
                raise UsageError(
                    f"{folder} has a result of {result.method} on {result.pair} that another "
                    "folder has, too: merge folders of different worlds, pairs or methods"
                )
            results[result.method, result.pair] = result
    # What an accumulator made of a method, and failed, has a name of its own: it comes last.
    methods = {name: at for at, name in enumerate(about.methods)}
    experiments = {name: at for at, name in enumerate(about.experiments)}

    def place(result: Result) -> tuple[int, int]:
        return methods.get(result.method, len(methods)), experiments[result.pair.experiment]

    return about, Results(sorted(results.values(), key=place))


def _pair(told: Any) -> Pair:
    experiment, world, train, test = told
    return Pair(experiment, world, tuple(train), test)
