"""The table at the end of a sweep: what was varied in each job, and what came out."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from hydra.core.override_parser.overrides_parser import OverridesParser

from placecue.commands.tables import table

#: Scores of the jobs are left in the folder that a sweep has for itself, from whichever process.
NAME = "placecue_job_{}.json"


def keep(folder: Path, job: int, words: Sequence[str], swept: Collection[str],
         scores: Mapping[str, float]) -> None:  # fmt: skip
    """Leave what a job has come to, for the table at the end.

    Parameters
    ----------
    folder : Path
        Of the sweep.
    job : int
        Its number.
    words : sequence of str
        Its overrides.
    swept : collection of str
        The keys that the sweep varies.
    scores : mapping of str to float
        What came out, in [0, 1].
    """
    parse = OverridesParser.create().parse_override
    varied = {
        parsed.key_or_group: word.partition("=")[2]
        for word in words
        if (parsed := parse(word)).key_or_group in swept
    }
    with suppress(OSError):  # without it the sweep is as good, only its table lacks a line
        folder.mkdir(parents=True, exist_ok=True)
        told = {"varied": varied, "scores": dict(scores)}
        (folder / NAME.format(job)).write_text(json.dumps(told), "utf-8")


def show(folder: Path) -> None:
    """Print the table of a sweep; nothing where its jobs left no scores."""
    found = {}
    for path in folder.rglob(NAME.format("*")):
        found[int(path.stem.rpartition("_")[2])] = json.loads(path.read_text("utf-8"))
    if len(found) < 2:
        return
    keys = list(dict.fromkeys(key for each in found.values() for key in each["varied"]))
    names = list(dict.fromkeys(name for each in found.values() for name in each["scores"]))
    rows = [
        [
            str(job),
            *(each["varied"].get(key, "") for key in keys),
            *(_percent(each["scores"].get(name)) for name in names),
        ]
        for job, each in sorted(found.items())
    ]
    print()
    table(["job", *keys, *(f"{name} (%)" for name in names)], rows)


def _percent(score: float | None) -> str:
    return "-" if score is None else f"{100 * score:.1f}"
