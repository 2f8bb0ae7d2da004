"""Low-level integration from the command line: a cue made of cues, and kernels over its parts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from command_line import placecue, succeeds
from results import rows

JOINT = ["cue=joint", "integrator=none"]
SVM = "cues.joint.classifier"


def shown(*words: str) -> dict[str, object]:
    """What ``--cfg job`` shows of the joint cue."""
    config = yaml.safe_load(succeeds("train", *JOINT, "log=x", *words, "--cfg", "job").out)
    joint: dict[str, object] = config["cues"]["joint"]
    return joint


def right(folder: Path) -> float:
    """The share of beliefs that are right."""
    table = rows(folder / "beliefs.csv")
    assert {row["cues"] for row in table} == {"joint"}
    return float(np.mean([row["label"] == row["truth"] for row in table]))


def test_it_is_trained_saved_and_asked(tmp_path: Path, log_a: Path, log_b: Path) -> None:
    words = ["cues.joint.parts=[crfh,laser]", "cues.joint.parts.crfh.bins=14"]
    few = [f"{SVM}.search.gamma=[0.01]", f"{SVM}.search.C=[1,10]"]
    cache = f"cache.folder={tmp_path / 'kept'}"
    succeeds("train", *JOINT, *words, *few, f"log={log_a}", f"out={tmp_path / 'm'}", cache)
    for name in ("one", "other"):
        succeeds("classify", f"model={tmp_path / 'm'}", f"log={log_b}", f"out={tmp_path / name}")
    assert right(tmp_path / "one") > 0.6
    texts = [(tmp_path / name / "beliefs.csv").read_text() for name in ("one", "other")]
    assert texts[0] == texts[1]


@pytest.mark.parametrize(
    "words",
    [
        [f"classifier@{SVM}=svm_joint_mkl", f"{SVM}.search.C=[10]"],
        [
            f"kernel@{SVM}.kernel=mkl",
            f"{SVM}.kernel.method=easymkl",
            f"{SVM}.search.C=[10]",
            f"{SVM}.search.gamma=null",
        ],
        [
            f"classifier@{SVM}=svm_joint_parts",
            f"{SVM}.kernel.kernels={{crfh: chi2, laser: {{plugin: rbf, gamma: 0.01}}}}",
            f"{SVM}.kernel.join=product",
            f"{SVM}.search.C=[10]",
            f"{SVM}.search.kernel__kernels__laser__gamma=[0.003,0.01]",
        ],
    ],
)
def test_kernels_of_the_parts(tmp_path: Path, log_a: Path, log_b: Path, words: list[str]) -> None:
    small = "cues.joint.parts.crfh.bins=14"
    succeeds("train", *JOINT, small, *words, f"log={log_a}", f"out={tmp_path / 'm'}")
    succeeds("classify", f"model={tmp_path / 'm'}", f"log={log_b}", f"out={tmp_path / 'c'}")
    assert right(tmp_path / "c") > 0.9


def test_parts_keep_their_own_parameters() -> None:
    joint = shown("cues.joint.parts=[laser,fisher_vector]", "cues.joint.parts.laser.preset=full")
    assert joint["plugin"] == "joint"
    parts = joint["parts"]
    assert isinstance(parts, dict)
    assert list(parts) == ["laser", "fisher_vector"]
    assert parts["laser"]["preset"] == "full"
    assert parts["laser"]["plugin"] == "laser"
    assert parts["fisher_vector"]["descriptors"]["plugin"] == "dense_sift"
    assert not any("classifier" in part for part in parts.values())
    word = "descriptors@cues.joint.parts.fisher_vector.descriptors=sift"
    parts = shown("cues.joint.parts=[fisher_vector]", word)["parts"]
    assert parts["fisher_vector"]["descriptors"]["plugin"] == "sift"  # type: ignore[index]


def test_both_words_choose_the_parts() -> None:
    for word in ("cues.joint.parts=[gist,sift]", "parts@cues.joint.parts=[gist,sift]"):
        assert list(shown(word)["parts"]) == ["gist", "sift"]  # type: ignore[call-overload]
    twice = "+cues.joint.parts.far={plugin: laser, clips: [50.0]}"
    parts = shown("cues.joint.parts=[laser]", twice)["parts"]
    assert list(parts) == ["laser", "far"]  # type: ignore[call-overload]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["cues.joint.parts=[crfh,crfh]"], "'crfh' is listed twice; a part is one cue"),
        (["cues.joint.parts=[crfh,lazer]"], "unknown cue 'lazer'; did you mean 'laser'?"),
        (["cues.joint.parts=[]"], "joint needs parts, cues by their names, such as"),
        (["cues.joint.parts=null"], "joint needs parts, cues by their names, such as"),
        (["cues.joint.parts=[crfh,joint]"], "takes cues in one piece as parts, got a Joint as"),
        (["cues.joint.parts.laser.presett=full"], "no 'presett' in cues.joint.parts.laser; did"),
        (["cues.joint.parts.crfh.classifier=svm"], "no 'classifier' in cues.joint.parts.crfh;"),
        (["cues.gist.parts=[crfh]"], "there is no 'parts' in cues.gist;"),
        ([f"classifier@{SVM}=adaboost"], "AdaBoost takes dense vectors, got features in parts"),
        ([f"kernel@{SVM}.kernel=mkl"], "search cannot vary 'gamma' of this SVM and kernel;"),
        (
            [f"classifier@{SVM}=svm_joint_parts", f"{SVM}.kernel.kernels={{crfh: chi2}}"],
            "kernel parts has kernels for the parts crfh, and the features have the parts crfh, "
            "laser: give one for each of these",
        ),
        (
            [
                f"classifier@{SVM}=svm_joint_parts",
                f"{SVM}.kernel.kernels={{crfh: match, laser: rbf}}",
            ],
            "part 'crfh': kernel Match takes set of local descriptors, got sparse histogram",
        ),
        ([f"kernel@{SVM}.kernel=chi2"], "kernel Chi2 takes dense vector or sparse histogram, got"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(log_a: Path, words: list[str], said: str) -> None:
    told = placecue("train", *JOINT, *words, f"log={log_a}", "out=m")
    assert told.status == 2
    assert said in told.line
