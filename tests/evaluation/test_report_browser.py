"""The page of an evaluation in a real browser, opened from a file."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import urlencode

import pytest

from browser import browser, ran
from made_results import QUOTES, SCRIPT, WORLD
from pages import HtmlPage

SHOWN = "[...document.querySelectorAll('.mistake')].filter((e) => e.offsetHeight > 0)"
COLUMN = """
const table = document.querySelector('#summary table');
const column = (n) => [...table.tBodies[0].rows].map((row) => row.cells[n].textContent);
const heads = [...table.tHead.rows[0].cells], sorts = () => heads.map((h) => h.ariaSort);
"""


@pytest.fixture(scope="module", autouse=True)
def _a_browser_is_there() -> None:
    browser()


def test_the_console_is_heard(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text("<body><script>undefined.x</script></body>")
    told, console = ran(page, "return 7", tmp_path)
    assert told == 7
    assert len(console) == 1
    assert "TypeError" in console[0]


def test_it_opens_fetches_nothing_and_runs_no_name(report: Path, tmp_path: Path) -> None:
    script = """
    return {
      title: document.title,
      resources: performance.getEntriesByType('resource').map((e) => e.name)
        .filter((name) => !name.startsWith('data:')),
      loaded: [...document.images].every((image) => image.loading === 'lazy'
        || (image.complete && image.naturalWidth > 0)),
      theme: document.getElementById('theme').textContent,
      figures: [...document.querySelectorAll('figure svg')].map((e) => e.clientWidth > 100),
    }"""
    told, console = ran(report, script, tmp_path)
    assert console == []
    assert told == {
        "title": f"Office {SCRIPT} & co",
        "resources": [],
        "loaded": True,
        "theme": "Dark",
        "figures": [True, True],
    }


def test_tables_sort(report: Path, tmp_path: Path) -> None:
    script = f"""{COLUMN}
    const told = [];
    for (const at of [1, 1, 2, 0]) {{
      heads[at].querySelector('button').click();
      told.push([column(at === 2 ? 2 : at), sorts()]);
    }}
    return told"""
    told, console = ran(report, script, tmp_path)
    assert console == []
    rising, falling, gaps, names = told
    assert rising == [["9.5", "88.2", "100.0"], [None, "ascending", None]]
    assert falling == [["100.0", "88.2", "9.5"], [None, "descending", None]]
    assert gaps == [["92.5 (3 pairs)", "95.1 ± 2.3", "-"], [None, None, "ascending"]]
    assert sorted(names[0]) == sorted([SCRIPT, QUOTES, WORLD])
    assert names[1] == ["ascending", None, None]


def test_the_address_says_what_is_shown(report: Path, tmp_path: Path) -> None:
    page = HtmlPage(report)
    methods = [each["value"] for each in page.of("option")]
    assert methods.count(QUOTES) >= 2
    every = page.of("article")
    [pair, *_] = [each["data-pair"] for each in every if each["data-class"] == QUOTES]
    of_class = [each for each in every if each["data-class"] == QUOTES]
    state = urlencode({"class": QUOTES, "matrix": WORLD, "experiment": "Exp 2"})
    script = f"""
    const one = {SHOWN}.map((e) => [e.dataset.class, e.dataset.pair]);
    const matrices = [...document.querySelectorAll('.matrices details')]
      .filter((e) => e.offsetHeight > 0)
      .map((e) => [e.dataset.matrix, e.dataset.experiment, e.open]);
    const said = document.querySelector('output').textContent;
    const select = document.querySelector('[data-key=pair]');
    select.value = {pair!r};
    select.dispatchEvent(new Event('change'));
    const two = {SHOWN}.map((e) => [e.dataset.class, e.dataset.pair]);
    const told = new URLSearchParams(location.hash.slice(1));
    return {{one, two, matrices, said, state: [...told.entries()].sort()}}"""
    told, console = ran(report, script, tmp_path, state)
    assert console == []
    assert told["one"] == [[QUOTES, each["data-pair"]] for each in of_class]
    assert told["said"] == f"{len(of_class)} of {len(every)} shown"
    assert told["two"] == [each for each in told["one"] if each[1] == pair]
    assert 0 < len(told["two"]) < len(told["one"]) < len(every)
    assert told["matrices"] == [[WORLD, "Exp 2", True]]
    assert told["state"] == [
        *(["class", QUOTES], ["experiment", "Exp 2"], ["matrix", WORLD], ["pair", pair]),
    ]


def test_mistakes_of_a_method(report: Path, tmp_path: Path) -> None:
    script = f"""return {SHOWN}.map((e) => [...e.querySelectorAll('.said > div:not(.good) dd')]
      .map((dd) => dd.textContent).join(', '))"""
    told, _ = ran(report, script, tmp_path, urlencode({"method": WORLD}))
    every = HtmlPage(report).of("article")
    assert 0 < len(told) < len(every)
    assert all(WORLD in wrong for wrong in told)


def test_it_fits_a_phone(report: Path, tmp_path: Path) -> None:
    (tmp_path / "report.html").write_bytes(report.read_bytes())
    phone = tmp_path / "phone.html"
    phone.write_text(
        "<body><iframe src=report.html style='width:390px;height:800px;border:0'></iframe></body>"
    )
    script = """
    const page = document.querySelector('iframe').contentDocument.documentElement;
    return [page.clientWidth, page.scrollWidth - page.clientWidth]"""
    told, console = ran(phone, script, tmp_path)
    assert console == []
    assert told[0] <= 390
    assert told[1] == 0


def test_the_theme_is_switched(report: Path, tmp_path: Path) -> None:
    script = """
    const colour = () => getComputedStyle(document.body).backgroundColor;
    const before = colour(), button = document.getElementById('theme');
    button.click();
    const dark = colour(), word = button.textContent;
    button.click();
    return {before, dark, word, after: colour()}"""
    told, _ = ran(report, script, tmp_path)
    assert told == {
        "before": "rgb(251, 251, 250)",
        "dark": "rgb(20, 23, 26)",
        "word": "Light",
        "after": "rgb(251, 251, 250)",
    }
