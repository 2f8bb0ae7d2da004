"""Wrong requests: one line that says what exists, and exit status 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import placecue, script

LASER = ["cue=laser", "integrator=none"]
SVM = "cues.laser.classifier"


def refused(*words: str) -> str:
    """Return the one line that a wrong request is answered with."""
    told = placecue(*words)
    assert told.status == 2, told.err
    assert told.out == ""
    return told.line


@pytest.fixture
def train(log_a: Path) -> list[str]:
    return ["train", *LASER, f"log={log_a}", "out=out"]


def nothing_but_empty_folders(folder: Path) -> bool:
    return all(path.is_dir() for path in folder.rglob("*"))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["tarin"], "unknown command 'tarin'; did you mean 'train'? available: "),
        (["--nope"], "unknown command '--nope'; available: "),
        (["train", "--nope"], "train: unrecognized arguments: --nope; see placecue train"),
        (["train", "--cfg", "nope"], "invalid choice: 'nope' (choose from"),
        (["train", "cue=[laser"], "train: cannot read 'cue=[laser'"),
        (["train", "log"], "train: 'log' is neither key=value nor a file that is there"),
        (["plugins", "a.mcap"], "'a.mcap' is no key=value, and plugins takes no paths"),
        (["train", "=3"], "train: '=3' has no key: give key=value"),
        (["train", "integrator=run (1)"], "put a value with special characters in quotes"),
        (["train", "log=a.mcap,b.mcap"], "Ambiguous value for argument 'log=a.mcap,b.mcap'"),
        (["train", "cue=lasr"], "unknown cue 'lasr'; did you mean 'laser'? available: "),
        (["train", "cue=[laser,smell]"], "unknown cue 'smell'; available: "),
        (["train", "integrator=svm_dsa"], "unknown integrator 'svm_dsa'; did you mean 'svm_das'?"),
        (["train", "source=carmne"], "unknown source 'carmne'; did you mean 'carmen'? available:"),
        (["train", *LASER, f"kernel@{SVM}.kernel=rfb"], "unknown kernel 'rfb'; did you mean 'rbf'"),
        (
            ["train", *LASER, f"classifier@{SVM}=svn"],
            "unknown classifier 'svn'; did you mean 'svm'",
        ),
        (["train", "lgo=a.mcap"], "there is no 'lgo'; did you mean 'log'? available: cache, cues,"),
        (["train", *LASER, "labels=a.csv"], "no 'labels'; did you mean source.labels?"),
        (["label", "bin_x=1"], "there is no 'bin_x'; did you mean accumulator.bin_x?"),
        (["convert", "source=carmen", "source.path=???", "out=x"], "needs source.path=...; see"),
        (["train", *LASER, f"{SVM}.qqq=1"], f"there is no 'qqq' in {SVM}; available: C, class_we"),
        (["train", "source.scn_topic=/scan"], "no 'scn_topic' in source; did you mean 'scan_topic"),
        (["label", "accumulator=nope"], "unknown accumulator 'nope'; available: "),
        (["label", "boundaries@accumulator.boundary=dor"], "unknown boundary 'dor'; did you mean"),
        (["label", "accumulator.bin=1"], "there is no 'bin' in accumulator; did you mean 'bin_"),
        (["convert", "source=nope", "out=a.mcap"], "unknown source 'nope'; available: "),
        (["convert", "out=a.mcap"], "You must specify 'source', e.g, source=<OPTION>"),
        (["plugins", "kind=cuee"], "no component of kind 'cuee'; did you mean 'cue'?"),
        (["-sc", "install=zsh"], "tab completion takes -sc install=SHELL"),
    ],
)
def test_what_there_is_not_is_answered_with_what_there_is(
    words: list[str], said: str, tmp_path: Path
) -> None:
    assert said in refused(*words)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["info"], "info needs log=...; see placecue info --help"),
        (["convert", "source=office"], "convert needs out=...; see placecue convert --help"),
        (["train", *LASER], "nothing to read: give log=FILE, log=[FILE,FILE], or source=NAME sou"),
        (["convert", "source=mcap", "out=a.mcap"], "nothing to read: give log=FILE"),
        (["classify"], "nothing to read: give log=FILE"),
        (["label"], "nothing to read: give log=FILE"),
    ],
)
def test_what_is_missing(words: list[str], said: str, tmp_path: Path) -> None:
    assert refused(*words).startswith(said)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([f"+{SVM}.qqq=1"], "classifier 'svm' has no parameter 'qqq'; available: C, class_weight"),
        (["+cues.laser.bar=1"], "cue 'laser' has no parameter 'bar'; available: angular_step"),
        (["cues.laser.plugin=lasr"], "unknown cue 'lasr'; did you mean 'laser'"),
        ([f"{SVM}=7"], f"{SVM} must be a mapping with 'plugin' and parameters, got 7"),
        ([f"{SVM}=swm"], "unknown classifier 'swm'; did you mean 'svm'?"),
        ([f"{SVM}.kernel=7"], "kernel must be a kernel such as {plugin: NAME} or null, got 7"),
        ([f"{SVM}.kernel=rbff"], "unknown kernel 'rbff'; did you mean 'rbf'?"),
        ([f"{SVM}.C=much"], "C must be a number, got 'much'"),
        ([f"{SVM}.C=-1"], "C must be above 0, got -1"),
        ([f"{SVM}.search.C=1"], "search must be a mapping of lists of values"),
        ([f"{SVM}.multiclass=ovo"], "'ovo'"),
        ([f"{SVM}.scaling=rnge"], "rnge"),
        (["cues.laser.clips=5"], "clips must be a list of numbers, got 5"),
        (["cues.laser.fourier=1.5"], "fourier must be a whole number, got 1.5"),
        (["cues.laser.preset=grp"], "unknown preset 'grp'; did you mean 'group'? available: full,"),
        (["source.tolerance=x"], "source 'mcap': tolerance must be a number, got 'x'"),
        (["source.parts=[scn]"], "'scn' is no part of an observation; did you mean 'scan'?"),
        (["folds.n_folds=few"], "folds: folds 'interleaved': n_folds must be a whole number, got"),
        (["folds=block"], "unknown folds 'block'; did you mean 'blocks'?"),
        (["folds=blocks", "folds.seconds=2"], "there is no 'seconds' in folds; available: n_folds"),
        ([f"{SVM}.folds=block"], "unknown folds 'block'; did you mean 'blocks'?"),
        ([f"{SVM}.folds={{plugin:blocks,n_folds:1}}"], "folds.n_folds must be 2 or more, got 1"),
        (["cues.lasr.classifier.search.C=[1]"], "there is no component cues.lasr.classifier; did"),
        (["out=null"], "out must be a path, got None: give out=PATH"),
        (["cues=null"], "a pipeline needs a cue or more: for example cue=[crfh,laser]"),
        (["cue=[crfh,laser]"], "2 cues (crfh, laser) and no integrator: choose one, such as"),
        (["source.scan_topic=/nope"], "source.scan_topic=/nope: no such topic in"),
        (["source.scan_topic=/odom"], "/odom"),
    ],
)
def test_values_that_cannot_be(
    train: list[str], words: list[str], said: str, tmp_path: Path
) -> None:
    if words == ["cue=[crfh,laser]"]:
        train.remove("cue=laser")
    assert said in refused(*train, *words)
    assert nothing_but_empty_folders(tmp_path)


@pytest.mark.parametrize(
    ("cue", "word", "said"),
    [
        ("bag_of_words", "cues.bag_of_words.step=8", "cues.bag_of_words.descriptors.step?"),
        ("fisher_vector", "cues.fisher_vector.cells=[4]", "cues.fisher_vector.descriptors.cells?"),
        ("bag_of_words", "+cues.bag_of_words.step=8", "descriptors.step?"),
        ("crfh", "cues.crfh.gamma=2", "cues.crfh.classifier.kernel.gamma?"),
    ],
)
def test_a_parameter_of_a_component_inside(
    cue: str, word: str, said: str, log_a: Path, tmp_path: Path
) -> None:
    told = refused("train", f"cue={cue}", "integrator=none", f"log={log_a}", "out=out", word)
    assert f"; did you mean {said}" in told
    assert nothing_but_empty_folders(tmp_path)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["batch=0"], "batch is 0; give a whole number of at least 1"),
        (["batch=some"], "batch is 'some'; give a whole number of at least 1"),
        (["accumulator.bin_x=0"], "bin_x is 0; give a number above 0"),
        (["accumulator.bin_x=wide"], "bin_x must be a number, got 'wide'"),
        (
            ["accumulator.boundary.door_noisy.open_beams=1.5"],
            "open_beams must be a whole number, got 1.5",
        ),
        (["model="], "model must be a path, got '': give model=PATH"),
        (["viewer=rviz"], "viewer is 'rviz'; available: rerun"),
        (["film=0"], "film is 0; give a whole number of at least 1"),
        (
            ["boundaries@accumulator.boundary=[evidence]"],
            "this accumulator takes no boundary ChangedEvidence",
        ),
    ],
)
def test_values_that_cannot_be_in_labelling(
    laser_model: Path, log_b: Path, words: list[str], said: str, tmp_path: Path
) -> None:
    told = refused("label", f"model={laser_model}", f"log={log_b}", "out=out", *words)
    assert said in told
    assert nothing_but_empty_folders(tmp_path)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["encoding=xml"], "unknown encoding 'xml': available: cdr, json"),
        (["source.start=soon"], "start must be a number or null, got 'soon'"),
    ],
)
def test_values_that_cannot_be_in_converting(
    log_a: Path, words: list[str], said: str, tmp_path: Path
) -> None:
    told = refused("convert", "source=mcap", f"log={log_a}", "out=made/a.mcap", *words)
    assert said in told
    assert nothing_but_empty_folders(tmp_path)


def test_two_candidates_are_listed_with_the_override_to_type(
    two_lasers: Path, tmp_path: Path
) -> None:
    words = ["train", *LASER, f"log={two_lasers}", "out=out"]
    line = refused(*words)
    assert (
        "2 topics with a laser scan: /front (sensor_msgs/msg/LaserScan, 20 messages), /re" in line
    )
    assert line.endswith("choose one, such as source.scan_topic=/front")
    assert nothing_but_empty_folders(tmp_path)
    assert placecue(*words, "source.scan_topic=/front").status == 0


@pytest.mark.parametrize("command", ["train", "classify", "label", "convert"])
def test_places_that_cannot_be_written(
    command: str, log_a: Path, laser_model: Path, tmp_path: Path
) -> None:
    file = tmp_path / "file"
    file.write_text("not a folder")
    words = {
        "train": ["cue=crfh", "integrator=none"],
        "classify": [f"model={laser_model}"],
        "label": [f"model={laser_model}"],
        "convert": ["source=mcap"],
    }[command]
    for out in (f"{file}/below", "/proc/nope", f"{file}/far/below"):
        line = refused(command, *words, f"log={log_a}", f"out={out}")
        assert line.startswith("cannot write ")
        assert line.endswith("choose another place with out=")
    assert list(tmp_path.iterdir()) == [file]
    assert file.read_text() == "not a folder"


def test_the_traceback_is_shown_when_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["train", *LASER, "log=nope.mcap"]
    told = [placecue(*words, "hydra.verbose=true")]
    monkeypatch.setenv("PLACECUE_TRACEBACK", "1")
    told.append(placecue(*words))
    for each in told:
        assert each.status == 1
        assert each.err.startswith("Traceback (most recent call last):")
        assert "FileNotFoundError" in each.err  # the cause is there too
        assert each.err.rstrip().endswith("placecue.errors.DataError: no such log: nope.mcap")
    usage = script("tarin")  # takes the environment over
    assert usage.status == 2
    assert usage.err.startswith("Traceback (most recent call last):")


def test_what_nobody_thought_of_is_one_line_too(
    laser_model: Path, log_b: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("placecue.commands.label.run", lambda config: 1 / 0)
    told = placecue("label", f"model={laser_model}", f"log={log_b}")
    assert told.status == 1
    assert "label broke off" in told.line
    assert "ZeroDivisionError: division by zero" in told.line
    assert "PLACECUE_TRACEBACK=1" in told.line
