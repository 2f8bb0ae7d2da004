"""A small evaluation of names that want to be something else in a page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from made_results import QUOTES, SCRIPT, WORLD, Made
from placecue.evaluation.report.evaluation import write_evaluation_report
from placecue.evaluation.report.table import Table
from placecue.evaluation.results.about import Method
from placecue.evaluation.results.result import Result
from placecue.evaluation.results.results import Results

#: Two rectangles; the second refers to a clip path, acts when clicked, and fetches.
SVG = """<?xml version="1.0"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN"
 "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
 viewBox="0 0 9 9"><style>*{fill:red}</style><script>document.title='taken'</script>
<defs><clipPath id="clip"><rect width="4" height="4" id="unused"/></clipPath></defs>
<rect width="9" height="9" clip-path="url(#clip)" onclick="document.title='taken'"/>
<use xlink:href="#clip"/><image xlink:href="http://example.org/a.png"/></svg>"""


@pytest.fixture(scope="session")
def made() -> Made:
    methods = {
        SCRIPT: Method(("crfh",)),
        QUOTES: Method(("laser",)),
        WORLD: Method(("crfh", "laser"), "svm_das"),
    }
    return Made(4, 30, methods, ("corridor", "kitchen", QUOTES, SCRIPT, WORLD))


@pytest.fixture(scope="session")
def results(made: Made) -> Results:
    every = list(made.results())
    every[2] = Result.failed(every[2].pair, every[2].method, f"no {SCRIPT} in the log")
    return Results(every)


@pytest.fixture(scope="session")
def report(made: Made, results: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    about = replace(made.about(), title=f"Office {SCRIPT} & co", warnings=[f"odd: {QUOTES}"])
    summary = Table(
        ["method", "Exp 1", "Exp 1, paper"],
        [[SCRIPT, 9.5, "-"], [QUOTES, 88.25, "95.1 ± 2.3"], [WORLD, 100.0, "92.5 (3 pairs)"]],
        "Balanced accuracy",
    )
    significance = Table(["methods", "p"], [["a > b", 0.0123]], digits=3)
    return write_evaluation_report(
        tmp_path_factory.mktemp("report"),
        about,
        results,
        {"Figure 7": (SVG, "All & sundry"), "Figure 8": (SVG, QUOTES)},
        [summary],
        [significance],
        made.open_recording,
    )
