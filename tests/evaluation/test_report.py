"""The page of an evaluation: whole, harmless, and bounded."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from made_results import QUOTES, SCRIPT, WORLD, Made
from pages import HtmlPage
from placecue import Observation
from placecue.errors import DataError
from placecue.evaluation.report.evaluation import evaluation_page, write_evaluation_report
from placecue.evaluation.report.table import Table
from placecue.evaluation.results.about import Method
from placecue.evaluation.results.results import Results


@pytest.fixture(scope="module")
def page(report: Path) -> HtmlPage:
    return HtmlPage(report)


def test_names_are_text_whatever_they_are(page: HtmlPage) -> None:
    for name in (SCRIPT, QUOTES, WORLD):
        assert name in page.text
    assert len(page.of("script")) == 2  # the page's own
    assert not [name for _, attributes in page.elements for name in attributes if name[:2] == "on"]
    assert page.of("b") != []
    values = [each["value"] for each in page.of("option")]
    assert {SCRIPT, QUOTES, WORLD} <= set(values)


def test_nothing_is_fetched(page: HtmlPage, report: Path) -> None:
    assert all(each.startswith(("#", "data:")) for each in page.addresses())
    assert "http" not in re.sub(r"data:image/jpeg;base64,[^\"]*", "", report.read_text())
    assert re.findall(r"url\((?!#)", report.read_text()) == []
    assert "@import" not in report.read_text()


def test_two_figures_share_no_name(page: HtmlPage) -> None:
    names = Counter(each["id"] for _, each in page.elements if "id" in each)
    assert set(names.values()) == {1}
    clips = [each["clip-path"] for each in page.of("rect") if "clip-path" in each]
    assert len(set(clips)) == 2
    assert {each.removeprefix("url(#").removesuffix(")") for each in clips if each} <= set(names)
    assert "fill:red" not in page.text


def test_what_stands_in_it(page: HtmlPage, made: Made) -> None:
    about = made.about()
    for word in (about.command, about.began, "numpy 2.4.6", "95.1", "0.012", "151.2"):
        assert word in page.text
    assert f"no {SCRIPT} in the log" in page.text
    assert "1 of 12 failed" in page.text
    for name, recording in about.recordings.items():
        assert name in page.text
        assert recording.log in page.text
    # Of three methods: each of four experiments and all, less the one whose only pair failed.
    assert len([each for each in page.of("details") if "data-matrix" in each]) == 3 * 5 - 1


def test_a_figure_that_is_none(made: Made, results: Results) -> None:
    with pytest.raises(DataError, match=r"figure 'Figure 9' is no SVG \(.*\): draw it again"):
        evaluation_page(made.about(), results, {"Figure 9": ("<p>", "")}, [], []).render()


def test_a_log_that_is_gone(made: Made, results: Results, tmp_path: Path) -> None:
    def opened(name: str) -> Iterator[Observation]:
        if name == "cloudy 2":
            raise DataError("cloudy2.mcap is not there")
        return made.open_recording(name)

    page = HtmlPage(write_evaluation_report(tmp_path, made.about(), results, {}, [], [], opened))
    assert "No pictures and scans of cloudy 2: cloudy2.mcap is not there" in page.text
    pictures = [each for each in page.of("img") if str(each["src"]).startswith("data:image/jpeg")]
    there = [each for each in page.of("article") if not str(each["data-pair"]).endswith("cloudy 2")]
    assert 0 < len(pictures) == len(there) < len(page.of("article"))


def test_a_name_that_is_no_text(made: Made, tmp_path: Path) -> None:
    about = replace(made.about(), title="run \udcff of\x00 2")
    path = write_evaluation_report(tmp_path, about, Results([]), {}, [], [])
    assert "<title>run ? of" in path.read_text(encoding="utf-8")


def test_figures_leave_less_room_for_mistakes(made: Made, results: Results) -> None:
    def shown(svg: str) -> int:
        figures = {"Figure 7": (svg, "")}
        page = evaluation_page(made.about(), results, figures, [], [])
        [section] = [each for each in page.sections if each.title == "Mistakes"]
        [mistakes] = section.parts
        return len(mistakes.shown)  # type: ignore[attr-defined]

    assert shown("<svg/>") > shown("<svg>" + " " * 8_420_000 + "</svg>") > 0
    assert shown("<svg>" + " " * 9_000_000 + "</svg>") == 0


def test_without_logs_and_results(made: Made, tmp_path: Path) -> None:
    about = replace(made.about(), recordings={}, methods={}, experiments={}, seconds={})
    page = HtmlPage(write_evaluation_report(tmp_path, about, Results([]), {}, [], []))
    assert "0 methods on 0 pairs" in page.text
    assert page.of("section") != []


def test_a_page_of_very_many_results_is_small(tmp_path: Path) -> None:
    methods = {f"method number {n} of many": Method(("crfh", "laser"), "gdas") for n in range(40)}
    made = Made(72, 316, methods)
    results = made.results()
    path = write_evaluation_report(tmp_path, made.about(), results, {}, [], [], made.open_recording)
    assert path.stat().st_size < 10_000_000
    page = path.read_text(encoding="utf-8")
    shown = re.findall(r'data-class="(.*?)" data-pair="(.*?)" data-methods="(.*?)"', page)
    wrong = sum(int((each.decided != each.truth).sum()) for each in results)
    assert f"({wrong} wrong decisions)" in page
    assert f"{len(shown)} samples are shown of" in page
    assert len(shown) >= 300
    assert {name for name, _, _ in shown} == set(made.classes)
    assert len({pair for _, pair, _ in shown}) == 72
    numbers = {number for _, _, each in shown for number in each.split()}
    assert numbers == {str(n) for n in range(40)}


def test_tables_show_and_sort_numbers_apart() -> None:
    table = Table(["a", "b"], [], digits=2)
    assert [table.text(each) for each in (1.005e3, 7, None, float("nan"), "x")] == [
        *("1005.00", "7", "–", "–", "x")
    ]
    assert table.key(0.123456) == "0.123456"
    assert table.key(7) is None
    means = ["95.1 ± 2.3", "9.25 ± 0.1 (11 pairs)", "88.0", "-", "Exp 1", "12th"]
    assert [table.key(each) for each in means] == ["95.1", "9.25", None, None, None, None]
    assert [table.is_number(each) for each in means] == [True, True, True, True, False, False]
    tested = ["+3.8", "-1.2", "< 0.001"]
    assert [table.key(each) for each in tested] == [None, None, "0.001"]
    assert all(table.is_number(each) for each in tested)
