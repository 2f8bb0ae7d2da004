"""``report.html`` of train, classify, label."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from command_line import placecue, succeeds
from mcap_logs import Ros2Log
from pages import HtmlPage
from results import rows
from rooms import ROOMS

QUICK = ["cue=laser", "integrator=none", "cues.laser.classifier.search=null"]


def is_alone(page: HtmlPage) -> bool:
    return all(each.startswith(("#", "data:")) for each in page.addresses())


def test_of_classify(tmp_path: Path, model: Path, log_b: Path) -> None:
    told = succeeds("classify", f"model={model}", f"log={log_b}", "out=out")
    assert f"report                              {Path('out', 'report.html')}" in told.out
    page = HtmlPage(Path("out", "report.html"))
    assert is_alone(page)
    table = [row for row in rows(Path("out", "beliefs.csv")) if row["truth"]]
    wrong = [row for row in table if row["truth"] != row["label"]]
    scores = json.loads(Path("out", "metrics.json").read_text())["methods"]
    for method in scores.values():
        assert f"{100 * method['balanced_accuracy']:.1f}" in page.text
    assert f"log={log_b}" in page.text
    if wrong:
        assert f"of {len(wrong)} wrong decisions" in page.text
    assert len(page.of("article")) == len(wrong)


def test_mistakes_have_pictures_and_scans(tmp_path: Path, model: Path, log_b: Path) -> None:
    # Every kitchen is called an office, so that there is something to be wrong about.
    moved = ["label_map={kitchen: office}", f"model={model}", f"log={log_b}", "out=out"]
    succeeds("classify", *moved)
    page = HtmlPage(Path("out", "report.html"))
    articles = page.of("article")
    assert {each["data-class"] for each in articles} >= {"office"}
    pictures = [each for each in page.of("img") if str(each["src"]).startswith("data:image/jpeg")]
    assert len(pictures) == len(articles) > 0
    assert len(page.of("circle")) == len(articles)


def test_of_label(tmp_path: Path, laser_model: Path, log_b: Path) -> None:
    succeeds("label", f"model={laser_model}", f"log={log_b}", "out=out")
    page = HtmlPage(Path("out", "report.html"))
    assert is_alone(page)
    titles = re.findall(r"<h2[^>]*>([^<]*)", Path("out", "report.html").read_text())
    assert titles[0] == "Map"
    [picture] = [each for each in page.of("img") if each["alt"] == "Semantic map"]
    assert str(picture["src"]).startswith("data:image/png;base64,")
    areas = json.loads(Path("out", "semantic_map.json").read_text())["areas"]
    assert areas
    for area in areas:
        assert area["label"] in page.text


def test_of_train(tmp_path: Path, model: Path) -> None:
    page = HtmlPage(model / "report.html")
    assert is_alone(page)
    for word in (*ROOMS, "svm_das(", "crfh(bins=28", "a.mcap", "All points of the search of laser"):
        assert word in page.text
    pictures = [str(each["alt"]) for each in page.of("img")]
    assert pictures == ["crfh", "laser", "integrator"]


def test_of_a_log_without_labels(tmp_path: Path, laser_model: Path, log_b: Path) -> None:
    dropped = "label_map={" + ", ".join(f"{name}: null" for name in ROOMS) + "}"
    succeeds("classify", f"model={laser_model}", f"log={log_b}", dropped, "out=out")
    page = HtmlPage(Path("out", "report.html"))
    assert "none of them with a true label" in page.text
    assert page.of("article") == []


@pytest.mark.parametrize("command", ["train", "classify", "label"])
def test_it_can_be_left_out(command: str, laser_model: Path, log_a: Path) -> None:
    words = [*QUICK] if command == "train" else [f"model={laser_model}"]
    told = succeeds(command, *words, f"log={log_a}", "out=out", "report=false")
    assert not Path("out", "report.html").exists()
    assert "report " not in told.out
    succeeds(command, *words, f"log={log_a}", "out=out", "overwrite=true")
    assert Path("out", "report.html").is_file()
    succeeds(command, *words, f"log={log_a}", "out=out", "overwrite=true", "report=false")
    assert not Path("out", "report.html").exists()


@pytest.mark.parametrize("command", ["train", "classify", "label", "demo"])
def test_it_is_true_or_false(command: str, laser_model: Path, log_a: Path) -> None:
    words = [*QUICK, f"log={log_a}"] if command == "train" else ["source.samples=4"]
    words = words if command in ("train", "demo") else [f"model={laser_model}", f"log={log_a}"]
    told = placecue(command, *words, "report=maybe", "out=out")
    assert (told.status, told.line) == (2, "report must be true or false, got 'maybe'")
    assert not Path("out").exists()


@pytest.mark.parametrize("command", ["train", "classify", "label"])
def test_one_that_fails_costs_a_line_only(
    command: str, laser_model: Path, log_a: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "placecue.evaluation.report.page.Page.render", lambda self: (1 / 0, "never")[1]
    )
    words = [*QUICK] if command == "train" else [f"model={laser_model}"]
    told = placecue(command, *words, f"log={log_a}", "out=out")
    assert told.status == 0
    assert told.line == (
        "out/report.html was not written, all else was: ZeroDivisionError: division by zero"
    )
    made = {path.name for path in Path("out").iterdir()}
    assert made >= ({"manifest.json"} if command == "train" else {"beliefs.csv", "metrics.json"})
    assert "report.html" not in made


def test_labels_and_paths_that_are_markup(tmp_path: Path, laser_model: Path) -> None:
    name = "<script>alert('x')</script> & \"hall\" 🚪"
    folder = tmp_path / "<b>logs & more"
    folder.mkdir()
    log = Ros2Log(folder / "a.mcap")
    for i in range(12):
        log.string(0.2 * i, name)
        log.scan(0.2 * i, [2.0 + (j + i) % 5 for j in range(61)], -1.5, 0.05, topic="/scan")
    log.close()
    written = folder / "a.mcap"
    told = placecue("classify", f"model={laser_model}", f"source.path='{written}'", "out=out")
    assert told.status == 0, told.err
    page = HtmlPage(Path("out", "report.html"))
    assert name in page.text
    assert len(page.of("script")) == 2
