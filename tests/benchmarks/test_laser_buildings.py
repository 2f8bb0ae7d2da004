"""What the page of buildings rests on: what an SVM is trained on, and the table."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from placecue.scaling import StandardScaling
from placecue.training_set import TrainingSet
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def buildings(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    for name in (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
    ):  # which it sets
        monkeypatch.setenv(name, "1")
    return import_module("laser_buildings")


def test_what_was_found_without_scaled_copies_is_trained_with_them(buildings: ModuleType) -> None:
    rng = np.random.default_rng(0)
    codes = rng.integers(4, size=80)
    features = codes[:, None] + 0.1 * rng.normal(size=(80, 2))
    samples = TrainingSet(
        features, np.array(["a", "b", "c", "d"])[codes], augmented=(features * 2,)
    )
    svm = SVM(RBF(), search={"C": [1.0, 10.0]}, scaling=StandardScaling())
    alone = buildings.trained(svm, samples, scales=False)
    chosen = alone.C_
    assert alone.scaling_.center_ == pytest.approx(features.mean(axis=0))
    both = buildings.trained(svm, samples, scales=True)
    assert chosen == both.C_
    assert both.scaling_.center_ == pytest.approx(1.5 * features.mean(axis=0))


def test_the_table_has_what_is_finished(buildings: ModuleType, tmp_path: Path) -> None:
    page, results = import_module("laser_buildings_page"), buildings.Results(tmp_path / "kept")
    truth = ["room", "room", "hallway", "hallway"]
    for number in range(6):
        # One building in two has half of its rooms taken for hallways.
        predicted = ["room", "hallway" if number % 2 else "room", "hallway", "hallway"]
        told = {"truth": truth, "predicted": predicted}
        results.keep(page.cell("SVM", "two"), number, [], told)
    written = tmp_path / "page.md"
    places = [f"<!-- table {name} -->\n<!-- end -->\n" for name in ("three", "two")]
    written.write_text("".join(places))
    page.write(written, results, ["SVM", "AdaBoost"])
    rows = [line for line in written.read_text().splitlines() if line.startswith("| SVM")]
    assert rows == ["| SVM | 87.5 | 100 | 75 | 100 | 75 | 100 | 75 | 75 | 100 |"]
    assert "AdaBoost" not in written.read_text()
