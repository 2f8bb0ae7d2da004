"""What ``placecue train`` shows of its searches, and how calibrated its probabilities are."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from sklearn.calibration import calibration_curve

from command_line import Told, placecue, succeeds
from placecue import Pipeline, PlacecueError
from placecue.components.manager import load_plugins
from placecue.evaluation import training_report
from placecue.evaluation.training_report import held_out_reliability, searches
from placecue.folds import InterleavedChunks
from placecue.scaling import QuantileScaling, RangeScaling
from placecue.storage.model import load_model
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import PLACES, Beams, Walk

REGISTRY = load_plugins(built_ins_only=True).registry
LASER = ["cue=laser", "integrator=none"]
SEARCH = "cues.laser.classifier.search"
PROBABILITY = "cues.laser.classifier.probability=sigmoid"


def shown_rows(told: Told) -> Iterator[list[str]]:
    """Return the words of each line of the table of chosen parameters."""
    lines = told.out.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("classifier"))
    for line in lines[start:]:
        if line.startswith(("parameter searches", "unknown", "note: ")):
            return
        yield line.split()


def markdown(path: Path) -> list[list[str]]:
    lines = path.read_text().splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_every_searched_parameter_is_shown_and_every_point_written(
    tmp_path: Path, log_a: Path
) -> None:
    out = tmp_path / "m"
    told = succeeds(
        *("train", "cue=[crfh,laser]", f"log={log_a}", f"out={out}"),
        *("cues.crfh.classifier.search=null", f"{SEARCH}.C=[1,10]", f"{SEARCH}.gamma=[0.01,0.1]"),
        *(f"+{SEARCH}.scaling=[range,quantiles]", f"+{SEARCH}.multiclass=[oaa,oao]"),
        *("integrator.classifier.search.C=[1,10]", "integrator.classifier.search.gamma=[0.1]"),
    )
    assert f"parameter searches  {out / 'search'}" in told.out
    assert sorted(path.name for path in (out / "search").iterdir()) == [
        *("integrator.md", "integrator.png", "laser.md", "laser.png"),
    ]
    pipeline = load_model(out, REGISTRY)
    laser = pipeline.cues["laser"].classifier
    head, laser_row, integrator_row = shown_rows(told)
    assert head[:5] == ["classifier", "C", "gamma", "scaling", "multiclass"]
    chosen = laser.chosen_
    scaling = {RangeScaling: "range", QuantileScaling: "quantiles"}[type(chosen["scaling"])]
    assert laser_row[:5] == [
        *("laser", f"{chosen['C']:g}", f"{chosen['gamma']:g}"),
        *(scaling, chosen["multiclass"]),
    ]
    best = f"{100 * max(laser.search_['balanced_accuracy']):.1f}"
    assert laser_row[5] == best
    assert integrator_row[:3] == ["integrator", f"{pipeline.integrator.classifier_.C_:g}", "0.1"]
    names, _, *points = markdown(out / "search" / "laser.md")
    assert sorted(names) == ["C", "balanced accuracy (%)", "gamma", "multiclass", "scaling"]
    assert len({tuple(point[:-1]) for point in points}) == len(points) == 2 * 2 * 2 * 2
    shares = [float(point[-1]) for point in points]
    assert shares == sorted(shares, reverse=True)
    assert points[0][-1] == best
    assert dict(zip(names, points[0], strict=True))["scaling"] == scaling
    for name in ("laser", "integrator"):
        assert cv2.imread(str(out / "search" / f"{name}.png")) is not None


@pytest.mark.parametrize(
    ("searched", "axes"),
    [
        (["gamma", "C"], {"across": "gamma", "up": "C"}),
        (["C"], {"up": "C"}),
        (["kernel__weight", "kernel__k__gamma", "C"], {"across": "kernel__k__gamma", "up": "C"}),
        (["rounds"], {"across": "rounds"}),
        (["rounds", "depth"], {"across": "rounds", "up": "depth"}),
    ],
)
def test_the_axes_of_a_heat_map(
    searched: list[str], axes: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[dict[str, str]] = []

    def drawn(results: object, path: Path, title: str = "", **given: str) -> None:
        told.append(given)

    monkeypatch.setattr(training_report, "draw_search", drawn)
    points = {name: [1.0, 2.0] for name in searched}
    svm = SVM(kernel=RBF(0.1)).fit(np.eye(4), list("abcd"))
    svm.search_ = {**points, "multiclass": ["oaa", "oao"], "balanced_accuracy": [0.4, 0.5]}
    training_report.write_training_report(Pipeline({"beams": (Beams(), svm)}), tmp_path)
    assert told == [axes]


def test_nothing_searched_and_no_probabilities_leave_nothing(tmp_path: Path, log_a: Path) -> None:
    out = tmp_path / "m"
    words = ["train", *LASER, f"log={log_a}", f"out={out}"]
    succeeds(*words, f"{SEARCH}.C=[1,10]", PROBABILITY)
    assert (out / "search" / "laser.md").exists()
    assert (out / "reliability.png").exists()
    told = succeeds(*words, f"{SEARCH}=null", "overwrite=true")
    assert not (out / "reliability.png").exists()
    assert not (out / "search").exists()
    assert "parameter searches" not in told.out
    assert "reliability diagram" not in told.out


def test_a_search_without_c_and_gamma_has_a_table_only(tmp_path: Path, log_a: Path) -> None:
    out = tmp_path / "m"
    words = [f"{SEARCH}=null", f"++{SEARCH}={{class_weight: [balanced, null]}}"]
    succeeds("train", *LASER, f"log={log_a}", f"out={out}", *words)
    assert [path.name for path in (out / "search").iterdir()] == ["laser.md"]
    names, _, *points = markdown(out / "search" / "laser.md")
    assert names == ["class_weight", "balanced accuracy (%)"]
    assert sorted(point[0] for point in points) == ["-", "balanced"]


def test_a_reliability_diagram_is_drawn(tmp_path: Path, log_a: Path) -> None:
    out = tmp_path / "m"
    told = succeeds("train", *LASER, f"log={log_a}", f"out={out}", f"{SEARCH}=null", PROBABILITY)
    assert f"reliability diagram  {out / 'reliability.png'}" in told.out
    picture = cv2.imread(str(out / "reliability.png"))
    assert min(picture.shape[:2]) >= 600
    loaded = load_model(out, REGISTRY)
    assert (loaded.held_out_, held_out_reliability(loaded)) == (None, {})


def test_the_diagram_is_of_held_out_samples() -> None:
    svm = {"kernel": RBF(gamma=0.1), "probability": "sigmoid"}
    pipeline = Pipeline({"beams": (Beams(), SVM(**svm))})  # type: ignore[arg-type]
    pipeline.fit(Walk(noise=1.0), reliability=True)
    measured = held_out_reliability(pipeline)["beams"]
    walk = list(Walk(noise=1.0))
    labels = np.array([each.label for each in walk])
    beams = np.stack([Beams().extract(each) for each in walk])
    values = np.empty((len(walk), len(PLACES)))
    for train, test in InterleavedChunks().split(labels, [each.stamp for each in walk]):
        stamps = np.array([each.stamp for each in walk])[train]
        copy = SVM(**svm).fit(beams[train], labels[train], stamps)  # type: ignore[arg-type]
        values[test] = copy.scores(beams[test]).values
    right = np.array(PLACES)[values.argmax(axis=1)] == labels
    accuracy, probability = calibration_curve(right, values.max(axis=1), n_bins=10)
    filled = measured.counts > 0
    assert measured.counts.sum() == len(walk)
    assert measured.accuracy[filled] == pytest.approx(accuracy)
    assert measured.probability[filled] == pytest.approx(probability)


def test_cues_with_probabilities_and_the_integrator_are_in_one_diagram() -> None:
    cues = {
        "beams": (Beams(), SVM(kernel=RBF(gamma=0.1), probability="isotonic")),
        "few": (Beams(2), SVM(kernel=RBF(gamma=0.1))),
    }
    svm = SVM(kernel=RBF(gamma=0.3), probability="sigmoid")
    pipeline = Pipeline(cues, SVMDAS(classifier=svm)).fit(Walk(noise=1.0), reliability=True)
    measured = held_out_reliability(pipeline)
    assert list(measured) == ["beams", "integrated"]
    assert [each.counts.sum() for each in measured.values()] == [320, 320]
    # Calibrated on what it has not seen, it is nearly as right as it claims.
    assert all(each.error < 0.15 for each in measured.values())


def test_a_picture_that_fails_loses_no_model(
    tmp_path: Path, log_a: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "m"

    def fail(*_: object, **__: object) -> None:
        assert not (out / "manifest.json").exists()  # which says that all is there
        raise PlacecueError("no room for a picture")

    monkeypatch.setattr(training_report, "draw_search", fail)
    told = placecue("train", *LASER, f"log={log_a}", f"out={out}", f"{SEARCH}.C=[1,10]")
    assert (told.status, told.line) == (1, "no room for a picture")
    assert searches(load_model(out, REGISTRY))["laser"]["C"]
