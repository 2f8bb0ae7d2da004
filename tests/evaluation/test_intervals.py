"""Intervals over scenes drawn anew, on samples that are counted by hand."""

import numpy as np
import pytest

from placecue.evaluation.figures.intervals import draw
from placecue.evaluation.figures.pooled import pooled
from placecue.evaluation.figures.spec import read
from placecue.evaluation.results.about import About, Method
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.results import Results

FOLDS = [Pair("folds", "", (f"log without fold {n}",), f"log fold {n}") for n in (1, 2)]
METHODS = {"A": Method(["A"]), "B": Method(["B"]), "A + B, vote": Method(["A", "B"], "vote")}
#: What is right of the six samples of each fold; the first three are kitchens, two scenes a class.
RIGHT = {"A": ("111000", "111000"), "B": ("100100", "000000"), "A + B, vote": ("111111", "111000")}
SCENES = {1: [0, 0, 1, 2, 2, 3], 2: [4, 4, 5, 6, 6, 7]}


def result(pair: Pair, method: str, right: str, scenes: list[int] | None) -> Result:
    truth = np.array([0, 0, 0, 1, 1, 1], np.int16)
    decided = np.where(np.array([*right]) == "1", truth, 1 - truth).astype(np.int16)
    decided[decided != truth] = -1 if method == "B" else 1 - truth[decided != truth]
    groups = np.array(scenes if scenes is not None else [], np.int64)
    n = len(truth)
    return Result(pair, method, ("kitchen", "office"), truth, decided, np.ones(n, np.float32),
                  np.arange(n), groups=groups)  # fmt: skip


def results(*, scenes: bool = True) -> Results:
    return Results(
        result(pair, method, of_fold, SCENES[number] if scenes else None)
        for method, right in RIGHT.items()
        for number, (pair, of_fold) in enumerate(zip(FOLDS, right, strict=True), start=1)
    )


def table(found: Results, **more: object) -> tuple[list[list[object]], list[list[object]], object]:
    about = About("", {}, METHODS, {"folds": 2})
    told = {"name": "Intervals", "kind": "intervals", **more}
    made = draw(found, read(told, found, about), about)
    return [list(row) for row in made.numbers.rows], [list(row) for row in made.table.rows], made


def test_samples_of_all_pairs_are_put_together() -> None:
    numbers, rows, _ = table(results())
    by_method = {row[0]: row for row in numbers}
    # A: all 6 kitchens, no office. B: 1 of 6, 1 of 6. Both: all 6, 3 of 6; four scenes a class.
    assert [by_method[m][4] for m in METHODS] == pytest.approx([50, 100 / 6, 75])
    assert all(row[2:4] == [12, 4] for row in numbers)
    # Kitchens of A and both are always right: the draws are of their offices.
    assert by_method["A"][5:7] == [50, 50]
    assert by_method["A"][7:] == [None] * 4
    low, high = by_method["A + B, vote"][5:7]
    assert (low, high) == (50, 100)
    assert by_method["A + B, vote"][7:] == ["A", pytest.approx(25), pytest.approx(0), 50]
    assert rows[2] == ["A + B, vote", "75.0 [50, 100]"]


def test_an_interval_of_the_difference_that_leaves_out_0_has_a_mark() -> None:
    found = [each for each in results() if each.method != "A + B, vote"]
    found += [result(pair, "A + B, vote", "111111", SCENES[n]) for n, pair in enumerate(FOLDS, 1)]
    _, rows, _ = table(Results(found))
    assert rows[2][1] == "100.0 [100, 100] ▲"


def test_where_no_scene_is_known_recordings_are_drawn() -> None:
    _, _, made = table(results(scenes=False))
    assert made.numbers.rows[0][3] == 1  # two folds of one recording
    assert made.notes[-1].startswith("A class comes from 1 of them only")


def test_a_table_of_rules_by_sets_of_cues() -> None:
    groups = {"alone": {"laser": "A", "camera": "B"}, "joined": {"vote": "A + B, vote"}}
    _, rows, made = table(results(), groups=groups)
    assert made.table.columns == ["experiment", "method", "alone", "joined"]
    assert [row[1] for row in rows] == ["laser", "camera", "vote"]
    assert rows[0][2] == "50.0 [50, 50]"
    assert [row[3] for row in rows] == [None, None, "75.0 [50, 100]"]


def test_methods_are_compared_on_the_samples_that_both_have() -> None:
    # One sample of fold 1 lacks cue A: a kitchen of scene 0, which the others have.
    whole = results()
    short = whole.get("A", FOLDS[0])
    keep = np.arange(6) != 1
    cut = Result(short.pair, "A", short.classes, short.truth[keep], short.decided[keep],
                 short.confidence[keep], short.stamps[keep], groups=short.groups[keep])  # fmt: skip
    others = [each for each in whole if (each.method, each.pair) != ("A", FOLDS[0])]
    found = Results([cut, *others])
    assert len(pooled(found, "A", "folds")) == 11
    numbers, _, _ = table(found)
    joined = next(row for row in numbers if row[0] == "A + B, vote")
    assert joined[8] == pytest.approx(25)  # all kitchens of both, 0 and 3 of 6 offices
