"""Averages within worlds, then over them, and the tables of all results, by hand."""

import csv
import io

import numpy as np
import pytest

from placecue.evaluation.results.average import average_confusion, average_score, averaged
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.results import Results
from placecue.evaluation.results.table import Table
from placecue.evaluation.results.tables import results_table, summary_table, write_results


def pair(world, test="b", experiment="Exp 1"):
    return Pair(experiment, world, ("a",), test)


def said(pair, truth, decided, classes="hko", method="m"):
    """A result from letters: the first ones of the classes, ``-`` where nothing was decided."""
    names = tuple(classes)
    numbers = [np.array([names.index(c) if c in names else -1 for c in text], np.int16)
               for text in (truth, decided)]  # fmt: skip
    n = len(truth)
    return Result(pair, method, names, *numbers, np.zeros(n, np.float32), np.zeros(n, np.int64))


def test_pairs_are_averaged_within_worlds_first():
    pairs = [pair("w0", t) for t in "bcd"] + [pair("w1")]
    found = averaged(pairs, [1.0, 2.0, 3.0, 10.0])
    assert found.mean == 6.0  # of 2 and 10, not 4
    assert found.deviation == 1.0  # of 1, 2, 3; one pair has none
    assert found.pairs == 4


def test_undefined_values_are_left_out():
    found = averaged([pair("w", t) for t in "bcd"], [[1.0, np.nan], [3.0, np.nan], [np.nan, 5.0]])
    assert found.mean.tolist() == [2.0, 5.0]
    assert found.deviation[0] == pytest.approx(2**0.5)
    assert np.isnan(found.deviation[1])
    assert found.pairs.tolist() == [2, 1]
    assert np.isnan(averaged([pair("w")], [np.nan]).mean)


def test_scores_are_in_percent_and_nothing_is_nothing():
    half = said(pair("w"), "hhkk", "hkkh")
    empty = said(pair("w", "c"), "", "")
    assert average_score([half, empty])[::2] == (50.0, 1)
    assert average_score([])[2] == 0


def test_confusion_counts_each_pair_alike_and_absent_classes_not():
    long = said(pair("w"), "h" * 8 + "kk", "h" * 4 + "k" * 4 + "k-")
    short = said(pair("w", "c"), "hh", "hh", classes="hp")
    classes, found = average_confusion([long, short])
    assert classes == ["h", "k", "o", "p"]
    assert found.mean[0].tolist() == [75.0, 25.0, 0.0, 0.0, 0.0]  # of 50 % and 100 %
    assert found.mean[1].tolist() == [0.0, 50.0, 0.0, 0.0, 50.0]  # one of two is undecided
    assert np.isnan(found.mean[2:]).all()
    assert found.pairs[:, 0].tolist() == [2, 1, 0, 0]


def test_a_row_for_each_result_failures_with_their_reason(tmp_path):
    good = said(pair("w", "run 2"), "hhk", "hkk")
    bad = Result.failed(pair("w", "c"), "m", "no scan, anywhere")
    text = write_results(Results([good, bad]), tmp_path).read_text()
    first, second = csv.DictReader(io.StringIO(text))
    assert (first["train"], first["test"]) == ("a", "run 2")
    assert (float(first["recall:h"]), float(first["recall:k"])) == (0.5, 1.0)
    assert (float(first["score"]), first["recall:o"], first["error"]) == (0.75, "", "")
    assert (second["score"], second["error"]) == ("", "no scan, anywhere")
    assert results_table(Results([])).csv().count("\n") == 1


def test_the_summary_tells_of_fewer_pairs():
    results = [said(pair("w", t), "hk", "hk" if t == "b" else "hh", method="all") for t in "bc"]
    results.append(said(pair("w"), "hk", "hh", method="some"))
    table = summary_table(Results(results), ["all", "some", "none"], ["Exp 1"])
    assert table.columns == ["method", "Exp 1 (2 pairs)"]
    assert [row[1] for row in table.rows] == ["75.0 ± 35.4", "50.0 (1 pair)", "–"]


TABLE = Table(["cue & more", "rate (%)"], [["a_b|c", 95.126], ["x < y", None]], digits=2)


def test_csv_is_read_back():
    assert list(csv.reader(io.StringIO(TABLE.csv()))) == [
        ["cue & more", "rate (%)"], ["a_b|c", "95.126"], ["x < y", ""],
    ]  # fmt: skip


def test_markdown_and_latex_are_escaped():
    assert TABLE.markdown().splitlines() == [
        "| cue & more | rate (%) |",
        "| --- | ---: |",
        "| a_b\\|c | 95.13 |",
        "| x < y | – |",
    ]
    lines = TABLE.latex().splitlines()
    assert lines[0] == r"\begin{tabular}{lr}"
    assert lines[2] == r"cue \& more & rate (\%) \\"
    assert lines[4] == r"a\_b\textbar{}c & 95.13 \\"
    assert lines[5] == r"x $<$ y & -- \\"
    # After \\ LaTeX reads [..] as a length, and * as that no page may end there.
    rows = Table(["of"], [["[a]"], ["*"], ["b*"]]).latex().splitlines()[4:-2]
    assert rows == [r"{}[a] \\", r"{}* \\", r"b* \\"]
