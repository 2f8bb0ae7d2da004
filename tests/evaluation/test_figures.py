"""Figures and tables of an evaluation: their numbers, their files, and what they refuse."""

import csv
import io
import itertools
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.text import Text
from scipy.stats import wilcoxon
from sklearn.metrics import confusion_matrix

from evaluated import CLASSES, evaluation, methods, pairs, result
from placecue.errors import DataError, UsageError
from placecue.evaluation.figures.make import KINDS, check, drawn, make, make_all
from placecue.evaluation.figures.ranks import alike
from placecue.evaluation.figures.significance import parts
from placecue.evaluation.figures.spec import of_methods
from placecue.evaluation.results.results import Results

ALL = "CRFH + SIFT + L-SVM"
SOME = ["CRFH OaO", "SIFT OaO", "L-SVM OaO", f"{ALL} SVM-DAS RBF"]
LONG = [f"{cues} {way}" for cues in (ALL, "CRFH + L-SVM")
        for way in ("G-DAS OaO", "G-DAS OaA", "G-DAS mOaA", "SVM-DAS linear", "SVM-DAS RBF",
                    "SVM-DAS HI")]  # fmt: skip


@pytest.fixture(scope="module")
def made_up():
    return evaluation(n=60)


@pytest.fixture(scope="module")
def results(made_up):
    return made_up[0]


@pytest.fixture(scope="module")
def about(made_up):
    return made_up[1]


def spec(kind, **more):
    return {"name": f"A {kind}", "kind": kind, **more}


def numbers(made):
    return list(csv.DictReader(io.StringIO(made.numbers.csv())))


def recalls(each):
    """Which share of each class is decided rightly."""
    return np.array([(each.decided[each.truth == c] == c).mean() for c in range(len(each.classes))])


def over_worlds(results, method, experiment, value):
    """The mean of a value over pairs, within each world and then over the worlds."""
    of_world = [[value(each) for each in results.of(method, experiment, world)]
                for world in results.worlds]  # fmt: skip
    return np.mean([np.mean(each, axis=0) for each in of_world], axis=0)


def texts(figure):
    """The boxes of all texts that are seen, after laying the figure out."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    found = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    return {text: text.get_window_extent(canvas.get_renderer()) for text in found}


def test_bars_are_means_over_pairs_within_worlds_first(results, about):
    _, made = drawn(spec("bars", methods=SOME), results, about)
    rows = numbers(made)
    assert len(rows) == 16
    for row in rows:
        value = over_worlds(results, row["method"], row["experiment"], lambda e: recalls(e).mean())
        assert float(row["mean (%)"]) == pytest.approx(100 * value, rel=1e-5)
    assert [row["pairs"] for row in rows[::4]] == ["24", "48", "24", "48"]
    heights = [bar.get_height() for bar in made.figure.axes[0].patches]
    assert sorted(heights) == pytest.approx(
        sorted(float(row["mean (%)"]) for row in rows), rel=1e-5
    )


def test_the_paper_s_numbers_are_marked(results, about):
    _, made = drawn(spec("bars", methods=["CRFH mOaA", "L-SVM mOaA"]), results, about)
    marks = [line.get_ydata() for line in made.figure.axes[0].lines if line.get_marker() == "D"]
    assert sorted(y for line in marks for y in line if np.isfinite(y)) == [92.5, 95.1]
    assert [row["paper (%)"] for row in numbers(made)][:2] == ["95.1", "92.5"]
    _, other = drawn(spec("bars", methods=SOME), results, about)
    assert not any(line.get_marker() == "D" for line in other.figure.axes[0].lines)


def test_groups_have_a_panel_an_experiment(results, about):
    groups = {cues: {way: f"{cues} {way}" for way in ("G-DAS OaO", "SVM-DAS RBF")}
              for cues in ("CRFH + SIFT", ALL)}  # fmt: skip
    _, made = drawn(spec("bars", groups=groups, experiments=["Exp 2", "Exp 4"]), results, about)
    panels = [axes for axes in made.figure.axes if axes.get_title()]
    assert [axes.get_title() for axes in panels] == ["Exp 2", "Exp 4"]
    assert [label.get_text() for label in panels[0].get_xticklabels()] == ["CRFH + SIFT", ALL]
    row = numbers(made)[1]
    assert (row["panel"], row["group"], row["bar"]) == ("Exp 2", "CRFH + SIFT", "SVM-DAS RBF")
    expected = over_worlds(results, row["method"], "Exp 2", lambda each: recalls(each).mean())
    assert float(row["mean (%)"]) == pytest.approx(100 * expected, rel=1e-5)


def test_a_method_has_one_colour_in_all_figures(results, about):
    def colours(**more):
        axes = drawn(spec("bars", **more), results, about)[1].figure.axes[0]
        handles, labels = axes.get_legend_handles_labels()
        bars = zip(handles, labels, strict=True)
        return {name: (to_hex(b[0].get_facecolor()), b[0].get_hatch()) for b, name in bars
                if name != "the paper"}  # fmt: skip

    every, some = colours(), colours(methods=[LONG[3], SOME[1]])
    assert len(set(every.values())) == len(methods()) == 40
    assert some.items() <= every.items()


def test_recognition_by_class(results, about):
    _, made = drawn(spec("classes", methods=SOME[-1:], experiments=["Exp 3"]), results, about)
    expected = 100 * over_worlds(results, SOME[-1], "Exp 3", recalls)
    assert [float(row["recall (%)"]) for row in numbers(made)] == pytest.approx(expected, rel=1e-5)
    assert made.table.columns == ["method", *CLASSES, "mean"]
    assert made.table.rows[0][-1] == pytest.approx(expected.mean())


def test_errors_are_spread_over_the_other_classes(results, about):
    def rows_of_confusion(each):
        counts = confusion_matrix(each.truth, each.decided, labels=[0, 1, 2, 3, 4, -1])[:5]
        return counts / counts.sum(axis=1, keepdims=True)

    _, made = drawn(spec("errors", methods=SOME, experiments=["Exp 1"]), results, about)
    shares = 100 * over_worlds(results, "SIFT OaO", "Exp 1", rows_of_confusion)
    rows = [row for row in numbers(made)
            if (row["actual class"], row["method"]) == ("kitchen", "SIFT OaO")]  # fmt: skip
    assert [row["taken for"] for row in rows] == [*CLASSES[:1], *CLASSES[2:], "undecided"]
    others = np.delete(shares[1], 1)
    close = {"rel": 1e-4, "abs": 1e-9}
    assert [float(row["% of class"]) for row in rows] == pytest.approx(others, **close)
    expected = 100 * others / others.sum()
    assert [float(row["% of errors"]) for row in rows] == pytest.approx(
        expected, rel=1e-4, abs=1e-9
    )


def test_a_class_without_errors_has_no_bar(about):
    perfect = [replace(each, decided=each.truth) for each in evaluation(("",), n=20)[0].of(SOME[0])]
    _, made = drawn(spec("errors", methods=SOME[:1]), Results(perfect), about)
    assert {row["% of errors"] for row in numbers(made)} == {""}
    assert {row["errors (% of class)"] for row in numbers(made)} == {"0"}


def test_shares_of_samples_that_cues_were_used_for(results, about):
    _, made = drawn(spec("used"), results, about)
    rows = numbers(made)
    assert {row["method"] for row in rows} == {m for m in about.methods if "confidence" in m}
    row = next(r for r in rows if (r["method"], r["cue"], r["experiment"])
               == (f"{ALL} confidence", "L-SVM", "Exp 4"))  # fmt: skip
    expected = over_worlds(results, row["method"], "Exp 4", lambda e: e.used["L-SVM"].mean())
    assert float(row["used (% of samples)"]) == pytest.approx(100 * expected, rel=1e-5)
    with pytest.raises(DataError, match="used all its cues"):
        drawn(spec("used", methods=SOME), results, about)


def test_runs_that_cannot_be_told_apart():
    assert alike(np.array([1.0, 1.5, 2.25, 4.0]), 1.0) == [(0, 1), (1, 2)]
    assert alike(np.array([1.0, 1.5, 2.0, 4.0]), 1.0) == [(0, 2)]
    assert alike(np.array([1.0, 3.0]), 1.0) == []


def test_ranks_are_over_the_pairs_that_all_have(results, about):
    fewer = Results(e for e in results if e.method != SOME[0] or e.pair.test != "night 3")
    _, made = drawn(spec("ranks", methods=SOME, experiments=["Exp 2"]), fewer, about)
    kept = [each.pair for each in results.of(SOME[0], "Exp 2") if each.pair.test != "night 3"]
    assert f"over {len(kept)} pairs" in made.notes[0]
    assert f"{48 - len(kept)} more pairs are left out" in made.notes[-1]
    # The joined method scores 8 points higher by construction.
    assert numbers(made)[0]["method"] == SOME[-1]
    assert sum(float(row["mean rank"]) for row in numbers(made)) == pytest.approx(10, rel=1e-5)


def test_significance_is_scipy_s(results, about):
    _, made = drawn(spec("significance", pairs=[SOME[::3], SOME[:2]]), results, about)
    for row in numbers(made):
        both = [[each.score for each in results.of(row[key])] for key in ("method", "against")]
        differences = np.round(np.subtract(*both), 10)
        p = wilcoxon(differences, zero_method="zsplit", method="asymptotic").pvalue
        assert float(row["p"]) == pytest.approx(p, rel=1e-4)
        assert row["pairs"] == "144"
    assert made.table.rows[0][-1] == "worse"
    _, less = drawn(spec("significance", pairs=[SOME[::-3]], alternative="less"), results, about)
    assert less.table.rows[0][-1] == "no difference is shown"


def test_a_method_is_compared_with_its_parts():
    known = methods()
    assert parts("CRFH OaO", known) == []
    assert parts("CRFH + SIFT SVM-DAS RBF", known) == [
        f"{cue} {way}" for cue in ("CRFH", "SIFT") for way in ("OaO", "OaA", "mOaA")
    ]
    found = parts(f"{ALL} SVM-DAS RBF", known)
    assert "SIFT + L-SVM SVM-DAS RBF" in found  # a cue was added to it
    assert f"{ALL} SVM-DAS HI" not in found
    assert not any("L-AB" in each for each in found)


def test_methods_that_share_no_pair_are_told(results, about):
    apart = Results([*results.of(SOME[0], "Exp 1"), *results.of(SOME[1], "Exp 2")])
    _, made = drawn(spec("significance", pairs=[SOME[:2]]), apart, about)
    assert (made.table.rows, made.notes[1]) == ([], "'CRFH OaO' and 'SIFT OaO' share no pair.")


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_written(kind, results, about, tmp_path):
    asked = SOME if kind != "used" else [f"{ALL} confidence"]
    told = spec(kind, title="50 % of what & how", methods=asked, experiments=["Exp 1", "Exp 4"])
    made = make(told, results, about, tmp_path)
    ends = {path.suffix: path for path in made.files}
    assert set(ends) == {".csv", ".tex", ".md"} | ({".png", ".pdf"} if made.drawn.figure else set())
    assert sorted(tmp_path.iterdir()) == sorted(made.files)
    assert len(list(csv.reader(ends[".csv"].open()))) > 1
    tex = ends[".tex"].read_text()
    assert tex.count(" & ") == (len(made.drawn.table.columns) - 1) * (tex.count("\\\\"))
    if made.drawn.figure:
        assert cv2.imread(str(ends[".png"])).shape[1] > 400
        assert ends[".pdf"].read_bytes().startswith(b"%PDF")
        page = ElementTree.fromstring(made.svg)
        words = "".join(page.itertext())
        assert "50 % of what & how" in words  # text is text
        assert made.svg == drawn(told, results, about)[1].svg("a-" + kind)
        assert "<dc:date>" not in made.svg


@pytest.mark.parametrize(
    ("kind", "asked"),
    [("bars", LONG), ("ranks", [*LONG, *list(methods())[:8]]), ("errors", LONG),
     ("confusion", LONG), ("classes", LONG)],
)  # fmt: skip
def test_names_do_not_run_into_one_another(kind, asked, results, about):
    _, made = drawn(spec(kind, methods=asked, title="A title of some length"), results, about)
    boxes = texts(made.figure)
    wide, high = made.figure.get_size_inches() * made.figure.dpi
    for text, box in boxes.items():
        if text.get_text() in asked or any(name in text.get_text() for name in asked):
            assert box.x0 >= 0, text
            assert box.x1 <= wide, text
            assert (box.y0 >= 0) & (box.y1 <= high), text
    for (one, a), (two, b) in itertools.combinations(boxes.items(), 2):
        apart = a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0
        assert apart, f"{one.get_text()} and {two.get_text()}"


def test_a_method_without_results_is_left_out_and_said(results, about, tmp_path):
    there = Results(each for each in results if each.method != SOME[1])
    made, warnings = make_all([spec("bars", methods=SOME)], there, about, tmp_path)
    assert warnings == ["A bars: no results of 'SIFT OaO' yet, drawn without it"]
    assert SOME[1] not in {row["method"] for row in numbers(made[0].drawn)}
    made, warnings = make_all([spec("bars", methods=SOME[1:2])], there, about, tmp_path / "none")
    assert (made, warnings) == ([], ["A bars is not drawn: there is no result of what it shows"])
    assert not (tmp_path / "none").exists()


def test_methods_may_be_called_otherwise(results, about):
    told = spec("bars", methods=SOME[:2], experiments=["Exp 1"], names={SOME[0]: "colours"})
    _, made = drawn(told, results, about)
    assert [row[0] for row in made.table.rows] == ["colours", "SIFT OaO"]
    assert [row["method"] for row in numbers(made)] == SOME[:2]
    assert "colours" in [text.get_text() for text in texts(made.figure)]


def test_of_some_methods_what_names_none_of_them_is_left_out():
    asked = [
        {"name": "1", "kind": "bars", "methods": ["a", "b"], "names": {"a": "A", "b": "B"}},
        {"name": "2", "kind": "bars", "groups": {"x": {"one": "a"}, "y": {"one": "c"}}},
        {"name": "3", "kind": "bars", "methods": ["c"]},
        {"name": "4", "kind": "summary"},
        {"name": "5", "kind": "significance", "pairs": [["a", "b"], ["a", "c"]]},
    ]
    assert of_methods(asked, ["a", "b"]) == [
        asked[0],
        {"name": "2", "kind": "bars", "groups": {"x": {"one": "a"}}},
        asked[3],
        {"name": "5", "kind": "significance", "pairs": [["a", "b"]]},
    ]
    assert of_methods(asked[:1], ["b"])[0]["names"] == {"b": "B"}


def test_fewer_pairs_are_told(results, about):
    fewer = Results(e for e in results if e.method != SOME[0] or e.pair.world == "world 1")
    _, made = drawn(spec("bars", methods=SOME, experiments=["Exp 1"]), fewer, about)
    assert made.notes == ("Exp 1: 'CRFH OaO' has 12 of 24 pairs.",)


@pytest.mark.parametrize(
    ("told", "said"),
    [
        (spec("bar"), "no kind 'bar'; did you mean 'bars'\\? available: bars, classes"),
        ({"kind": "bars"}, "has no name"),
        (spec("bars", methods=["CRFH Oao"]), "unknown method 'CRFH Oao'.*did you mean 'CRFH OaO'"),
        (spec("bars", experiments=["Exp 5"]), "unknown experiment 'Exp 5'.*available: Exp 1"),
        (spec("bars", groups={"A": {"b": "none"}}), "unknown method 'none'"),
        (spec("bars", method="CRFH OaO"), "takes no 'method' .*did you mean 'methods'"),
        (spec("bars", methods="CRFH OaO"), "methods is to be a list of methods, here it is 'CRFH"),
        (spec("bars", groups=["CRFH OaO"]), "groups is to be by group"),
        (spec("bars", bottom="low"), "bottom is to be a number under 100"),
        (spec("ranks", alpha=5), "alpha is to be a number between 0 and 1"),
        (spec("significance", alternative="more"), "one of two-sided, greater, less"),
        (spec("significance", pairs=[["CRFH OaO"]]), "pairs is to be a list of two methods each"),
        (spec("errors", bottom=3), "takes no 'bottom'"),
        (spec("bars", methods=SOME, groups={"A": {"b": SOME[0]}}), "leave methods out"),
        (spec("bars", names={SOME[0]: "one", SOME[1]: "one"}), "names call two methods 'one'"),
        (spec("bars", names={SOME[0]: SOME[1]}), "names call two methods 'SIFT OaO'"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_is_refused_in_a_line(told, said, about):
    with pytest.raises(UsageError, match=said) as caught:
        check([told], about)
    assert "\n" not in str(caught.value)


def test_two_of_one_name_are_refused(about):
    with pytest.raises(UsageError, match="two figures or tables are called 'a BARS'"):
        check([spec("bars"), {**spec("ranks"), "name": "a BARS"}], about)


def test_too_many_or_too_few_methods(results, about, tmp_path):
    with pytest.raises(UsageError, match="13 confusion matrices are too many"):
        drawn(spec("confusion", methods=list(methods())[:13]), results, about)
    _, warnings = make_all([spec("ranks", methods=SOME[:2])], results, about, tmp_path)
    assert "three methods or more, here are 2" in warnings[0]


def test_names_that_are_formulas_or_foreign_are_drawn_as_they_are(about, caplog, recwarn):
    pair = pairs()[0]
    found = Results([result(pair, "CRFH OaA", 0.9, classes=("$\\frac$ 5", "办公室"))])
    made = drawn({"name": "Recalls", "kind": "classes", "methods": ["CRFH OaA"]}, found, about)[1]
    svg = made.svg()
    assert "$\\frac$ 5" in svg
    assert "办公室" in svg
    assert not recwarn.list
    # Said once however often it is drawn, and not at all where a font has them.
    assert [m for m in caplog.messages if "PNG and PDF show boxes" not in m] == []
    assert len(caplog.messages) <= 1


def test_recordings_with_other_classes_and_one_pair(about):
    one = result(pairs()[0], SOME[0], 0.8, classes=("attic", "cellar"))
    two = result(pairs()[1], SOME[0], 0.8)
    for kind in ("bars", "classes", "errors", "confusion", "summary"):
        _, made = drawn(spec(kind, methods=SOME[:1]), Results([one]), about)
        assert numbers(made)
    _, made = drawn(spec("classes", methods=SOME[:1]), Results([one, two]), about)
    assert made.table.columns == ["method", "attic", "cellar", *CLASSES, "mean"]


def test_nothing_heavy_is_imported_before_something_is_drawn():
    code = """if True:
        import sys, placecue.evaluation.figures.make
        print([m for m in ("matplotlib", "pandas", "scikit_posthocs") if m in sys.modules])
    """
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
