"""The page of a run over a log: its map, its scores, and its mistakes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from placecue.evaluation.report import confusion
from placecue.evaluation.report.figure import Figure
from placecue.evaluation.report.page import Page, Part, Section
from placecue.evaluation.report.sampled import MistakeSample
from placecue.evaluation.report.table import Facts, Notes, Table
from placecue.evaluation.tally import INTEGRATED, Tally
from placecue.semantic_map import UNKNOWN, SemanticMap


def run_page(
    title: str,
    facts: Facts,
    tally: Tally,
    sample: MistakeSample,
    semantic_map: SemanticMap | None = None,
    picture: Path | None = None,
    doubts: Sequence[str] = (),
) -> Page:
    """Return the page of a log that was classified, or labelled too.

    Parameters
    ----------
    title : str
        Its heading.
    facts : Facts
        What was run on what.
    tally : Tally
        The scores; there are none where the log is not labelled.
    sample : MistakeSample
        Mistakes.
    semantic_map : SemanticMap, optional
        What the log was labelled with; the page opens with it.
    picture : Path, optional
        The drawn map, ``.png``.
    doubts : sequence of str
        What speaks against the map.
    """
    scored = bool(tally.counts)
    mistakes = sample.mistakes
    sections = [
        Section("Map", [*_map(semantic_map, picture), *_doubts(doubts)]),
        Section("Scores", [_scores(tally)] if scored else []),
        Section("Confusion", [confusion.of_tally(tally)] if scored else []),
        Section("Cues", [_cues(tally)] if tally.used or tally.missing else []),
        Section("Mistakes", [mistakes] if mistakes.total else []),
        Section("What was run", [facts]),
    ]
    return Page(title, sections, _lead(tally))


def _lead(tally: Tally) -> str:
    if not tally.counts:
        return f"{tally.believed} observations, none of them with a true label."
    score = 100 * tally.balanced_accuracy(INTEGRATED)
    return (
        f"Balanced accuracy {score:.1f} % over {len(tally.classes())} classes; "
        f"{tally.unlabelled} observations have no label, {tally.unusable} were unusable."
    )


def _map(semantic_map: SemanticMap | None, picture: Path | None) -> list[Part]:
    if semantic_map is None:
        return []
    parts: list[Part] = []
    if picture is not None:
        caption = "Areas by class, the paler the less sure; dots are single beliefs."
        parts.append(Figure("Semantic map", "", caption, picture.read_bytes()))
    nodes = Counter(node.area for node in semantic_map.nodes)
    rows = [
        [
            str(area.id),
            area.label,
            area.confidence if area.label != UNKNOWN else None,
            nodes[area.id],
            (area.end - area.start) / 1e9,
        ]
        for area in semantic_map.areas
    ]
    headings = ["area", "label", "confidence", "nodes", "seconds from first to last seen"]
    return [*parts, Table(headings, rows, "Areas", digits=2)]


def _doubts(doubts: Sequence[str]) -> list[Part]:
    return [Notes(doubts)] if doubts else []


def _scores(tally: Tally) -> Table:
    methods, named = tally.methods, tally.says_unknown
    headings = ["class", "samples", *methods, *([f"{UNKNOWN} (%)"] if named else [])]
    rows = [
        [
            name,
            tally.samples(name),
            *(_percent(tally.recall(method, name)) for method in methods),
            *([_percent(tally.unknown(INTEGRATED, name))] if named else []),
        ]
        for name in tally.classes()
    ]
    mean = [_percent(tally.balanced_accuracy(method)) for method in methods]
    share = [_percent(tally.unknown(INTEGRATED))] if named else []
    foot = ["balanced accuracy", None, *mean, *share]
    return Table(headings, rows, "Recognised, % of each class", foot=foot)


def _cues(tally: Tally) -> Table:
    cues = list(dict.fromkeys([*tally.used, *tally.missing]))
    rows = [
        [cue, tally.used[cue], _percent(tally.used[cue] / max(tally.believed, 1)),
         tally.missing[cue]]
        for cue in cues
    ]  # fmt: skip
    headings = ["cue", "observations that it was asked at", "% of all", "missing at"]
    return Table(headings, rows)


def _percent(share: float | None) -> float | None:
    return None if share is None else 100 * share
