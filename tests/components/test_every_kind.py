"""One class of every kind from a third party: installed, used end to end, type-checked."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer
from omegaconf import OmegaConf

from command_line import installed
from placecue.components.hooks import KINDS
from results import rows

DATA = Path(__file__).parents[1] / "data" / "placecue-everykind"
ROOMS = {"corridor": (24.0, 2.0), "hall": (20.0, 18.0), "kitchen": (4.0, 4.0), "lab": (9.0, 7.0)}
CLASSIFIER = "cues.sectors.classifier"


@pytest.fixture(scope="module")
def ran(wheel: Path, tmp_path_factory: pytest.TempPathFactory):  # type: ignore[no-untyped-def]
    """Run commands in one folder; each must succeed."""
    folder = tmp_path_factory.mktemp("everykind")

    def run(*words: str) -> Path:
        done = installed(wheel, *words, PLACECUE_CACHE=str(folder / "cache"), PWD=str(folder))
        assert done.returncode == 0, done.stderr
        return folder

    return run


@pytest.fixture(scope="module")
def model(ran, tmp_path_factory: pytest.TempPathFactory) -> Path:  # type: ignore[no-untyped-def]
    """A model of nothing but the package's components, trained by the command."""
    folder = tmp_path_factory.mktemp("model")
    ran(
        "train",
        "source=boxes",
        f"out={folder}",
        "cue=[sectors,laser]",
        f"classifier@{CLASSIFIER}=similar",
        f"kernel@{CLASSIFIER}.kernel=laplace",
        f"scaling@{CLASSIFIER}.scaling=median",
        f"folds@{CLASSIFIER}.folds=odd_even",
        f"{CLASSIFIER}.folds.run=2",
        "classifier@cues.laser.classifier=similar",
        "cues.laser.classifier.kernel={plugin:laplace,gamma:0.01}",
        "cues.laser.classifier.scaling=median",
        "integrator=stacked",
        "classifier@integrator.classifier=similar",
        "kernel@integrator.classifier.kernel=laplace",
        "folds=odd_even",
    )
    return folder


def test_every_kind_is_listed(python: Path) -> None:
    listed = installed(python, "plugins")
    assert listed.returncode == 0, listed.stderr
    mine = [line.split() for line in listed.stdout.splitlines() if "placecue-everykind" in line]
    assert {row[0] for row in mine} == set(KINDS)
    assert all(row[-3:] == ["placecue-everykind", "0.7", "ok"] for row in mine)


def test_options_are_made_that_choose_what_stands_inside(wheel: Path) -> None:
    words = [
        "cue=sectors",
        f"classifier@{CLASSIFIER}=similar",
        f"kernel@{CLASSIFIER}.kernel=laplace",
        f"{CLASSIFIER}.kernel.gamma=0.25",
        f"folds@{CLASSIFIER}.folds=odd_even",
        "integrator=stacked",
        "classifier@integrator.classifier=adaboost",
        "folds=odd_even",
        "folds.run=9",
    ]
    shown = installed(wheel, "train", *words, "--cfg", "job")
    assert shown.returncode == 0, shown.stderr
    config = OmegaConf.create(shown.stdout)
    sectors = {
        "plugin": "similar",
        "kernel": {"plugin": "laplace", "gamma": 0.25},
        "scaling": None,
        "folds": {"plugin": "odd_even", "n_folds": 2, "run": 3},
        "scale": 1.0,
    }
    assert config.cues == {"sectors": {"plugin": "sectors", "count": 6, "classifier": sectors}}
    assert config.integrator.classifier.plugin == "adaboost"
    assert config.folds == {"plugin": "odd_even", "n_folds": 2, "run": 9}


def test_the_model_names_and_keeps_them(model: Path) -> None:
    manifest = json.loads((model / "manifest.json").read_text())
    mine = {
        (each["kind"], each["name"])
        for each in manifest["plugins"]
        if each["distribution"] == "placecue-everykind"
    }
    assert mine == {
        ("cue", "sectors"),
        ("classifier", "similar"),
        ("kernel", "laplace"),
        ("scaling", "median"),
        ("folds", "odd_even"),
        ("integrator", "stacked"),
        ("layout", "unlikeness"),
    }
    pipeline = manifest["pipeline"]
    assert pipeline["folds"] == {"plugin": "odd_even", "n_folds": 2, "run": 3}
    assert pipeline["cues"]["sectors"]["classifier"]["folds"]["run"] == 2
    state = json.loads((model / "state.json").read_text())
    learned = state["cues"]["sectors"]["classifier"]
    assert learned["layout_"]["spec"]["plugin"] == "unlikeness"
    assert learned["scaling_"]["spec"]["plugin"] == "median"
    assert learned["accuracy_"] > 0.9  # held out by folds of its own


def test_the_model_classifies_another_recording(ran, model: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    ran("classify", f"model={model}", "source=boxes", "source.seed=5", f"out={tmp_path}")
    table = rows(tmp_path / "beliefs.csv")
    truth = np.repeat(list(ROOMS), 8).tolist() * 2
    assert [row["label"] for row in table] == truth


def test_areas_end_where_its_boundary_says(ran, model: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    words = ["accumulator=journal", "boundary@accumulator.boundary=metres", "source=boxes"]
    ran("label", *words, "source.rounds=1", f"model={model}", f"out={tmp_path}")
    areas = json.loads((tmp_path / "semantic_map.json").read_text())["areas"]
    assert [area["label"] for area in areas] == list(ROOMS)


def test_its_message_is_read(ran, model: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    log = tmp_path / "acme.mcap"
    angles = np.radians(np.linspace(-90, 90, 61))
    with log.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("acme.Beams", "jsonschema", b"{}")
        channel = writer.register_channel("/beams", "json", schema)
        for number, (length, width) in enumerate(ROOMS.values()):
            with np.errstate(divide="ignore"):
                ends = np.abs(length / 2 / np.cos(angles))
                sides = np.abs(width / 2 / np.sin(angles))
            message = {"ms": 1000 * (number + 1), "cm": (100 * np.minimum(ends, sides)).tolist()}
            stamp = (number + 1) * 1_000_000_000
            writer.add_message(channel, stamp, json.dumps(message).encode(), stamp)
        writer.finish()
    ran("classify", f"model={model}", f"log={log}", f"out={tmp_path / 'out'}")
    table = rows(tmp_path / "out" / "beliefs.csv")
    assert [row["label"] for row in table] == list(ROOMS)


def test_it_passes_a_strict_type_checker(tmp_path: Path) -> None:
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path, "everykind"],
        cwd=DATA / "src",
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "no issues found in 11 source files" in checked.stdout
