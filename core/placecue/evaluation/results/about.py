"""What an experiment was: recordings, pairs, methods, versions; kept beside its results."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Self

from placecue.atomic import write_json
from placecue.errors import DataError

FILE = "experiment.json"
FORMAT = 1


@dataclass(frozen=True)
class Recording:
    """A log that models are trained or tested on.

    Parameters
    ----------
    log : str
        Its path, or what else it was read from.
    digest : str
        Of its content.
    metadata : mapping of str to str
        Conditions: illumination, run.
    classes : mapping of str to int
        Labelled samples of each class.
    source : mapping
        The config of the source that reads it.
    """

    log: str
    digest: str
    metadata: Mapping[str, str] = field(default_factory=dict)
    classes: Mapping[str, int] = field(default_factory=dict)
    source: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Method:
    """Cues with their classifiers, and how they are integrated.

    Parameters
    ----------
    cues : sequence of str
        The single-cue models that it joins.
    integrator : str
        What joins them; empty for one cue.
    words : str
        What chooses it, as after ``placecue train``.
    """

    cues: Sequence[str]
    integrator: str = ""
    words: str = ""


@dataclass(frozen=True)
class About:
    """What was evaluated.

    Parameters
    ----------
    title : str
        A heading.
    recordings : mapping of str to Recording
        By name, as pairs name them; with several worlds ``WORLD/NAME``.
    methods : mapping of str to Method
        By name, in the order in which they are shown.
    experiments : mapping of str to int
        How many pairs each has, in the order in which they are shown.
    digests : sequence of str
        Of all results that there are to be: those of older runs in the folder are others.
    areas : sequence of str
        The same of what accumulators make of them.
    figures, tables : sequence of mapping
        What to draw, as the experiment's config says.
    paper : mapping of str to mapping of str to float
        What a paper says, %: by method and experiment.
    versions : mapping of str to str
        Of placecue, its plugins and the packages that decide results.
    command : str
        The command line.
    began : str
        When, ISO 8601.
    seconds : mapping of str to float
        What each step took in all.
    warnings : sequence of str
        What was told meanwhile.
    failures : sequence of mapping
        ``method``, ``pair`` and ``error`` of what came to nothing.
    """

    title: str
    recordings: Mapping[str, Recording]
    methods: Mapping[str, Method]
    experiments: Mapping[str, int]
    digests: Sequence[str] = ()
    areas: Sequence[str] = ()
    figures: Sequence[Mapping[str, Any]] = ()
    tables: Sequence[Mapping[str, Any]] = ()
    paper: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    command: str = ""
    began: str = ""
    seconds: Mapping[str, float] = field(default_factory=dict)
    warnings: Sequence[str] = ()
    failures: Sequence[Mapping[str, Any]] = ()

    def save(self, folder: Path) -> None:
        """Write it into a folder."""
        write_json(folder / FILE, {"format": FORMAT, **asdict(self)})

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Return what stands in a folder.

        Raises
        ------
        DataError
            If there is none, or it is damaged or of another version.
        """
        path = folder / FILE
        try:
            told = json.loads(path.read_text(encoding="utf-8"))
            if told.pop("format") != FORMAT:
                raise DataError(f"{path} is of another version of placecue: evaluate again")
            told["recordings"] = {n: Recording(**each) for n, each in told["recordings"].items()}
            told["methods"] = {n: Method(**each) for n, each in told["methods"].items()}
            return cls(**told)
        except FileNotFoundError as error:
            raise DataError(
                f"{folder} holds no {FILE}: give the folder that placecue evaluate wrote"
            ) from error
        except (OSError, ValueError, LookupError, TypeError, AttributeError) as error:
            raise DataError(f"{path} cannot be read ({error}): evaluate again") from error
