"""What commands say about themselves, without doing anything."""

import os
import re
import shlex
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest
import yaml

from command_line import SCRIPT, placecue, script, succeeds
from placecue import __version__
from placecue.commands.help.examples import EXAMPLES
from placecue.commands.names import COMMANDS

NEEDED = {
    "classify": ["model=m", "log=a.mcap"],
    "convert": ["source=carmen", "log=a.log", "out=a.mcap"],
    "info": ["log=a.mcap"],
    "label": ["model=m", "log=a.mcap"],
    "suggest": ["model=m", "log=a.mcap"],
    "teach": ["model=m", "log=a.mcap"],
}


@pytest.mark.parametrize("words", [[], ["--help"], ["-h"], ["help"]])
def test_help_names_every_command(words: list[str]) -> None:
    told = succeeds(*words)
    for command, summary in COMMANDS.items():
        assert f"  {command}" in told.out
        assert summary in told.out


@pytest.mark.parametrize("words", [["--help"], ["plugins"], ["train", "--help"]])
def test_nobody_reads_on(words: list[str]) -> None:
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([SCRIPT, *words], stdout=write, stderr=subprocess.PIPE, check=False)
    os.close(write)
    assert done.returncode != 0
    assert done.stderr == b""


def test_version() -> None:
    assert succeeds("--version").out == f"placecue {__version__}\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command(command: str) -> None:
    told = succeeds(command, "--help").out
    assert told.startswith(f"placecue {command} ")
    config = yaml.safe_load((files("placecue_conf") / f"{command}.yaml").read_text())
    own = {key for key in config if key not in ("defaults", "hydra", "source")}
    assert {key for key in own if not re.search(rf"^  .*\b{key}\b", told, re.M)} == set()
    assert "  placecue " in told.partition("essentials:")[0]  # examples come first
    assert "--cfg job" in told
    assert "Hydra" not in told.partition("--hydra-help")[0]


def test_help_has_five_examples_and_fits_its_command() -> None:
    told = succeeds("train", "--help").out
    examples = told.partition("examples:\n")[2].partition("\n\n")[0].splitlines()
    assert len(examples) == 5
    assert all(line.startswith("  placecue train ") for line in examples)
    assert "accumulator" not in told
    assert "accumulator=crf" in succeeds("label", "--help").out
    assert "cues.crfh.bins" not in succeeds("train", "cue=laser", "-h").out
    assert "source.laser " in succeeds("convert", "source=carmen", "--help").out


def test_each_example_composes(tmp_path: Path) -> None:
    """Whatever help shows is understood, files apart."""
    for command, examples in EXAMPLES.items():
        for example in examples:
            _, _, *words = shlex.split(example)
            if "-m" in words or "--json" in words:
                continue
            told = placecue(command, *words, "--cfg", "job")
            there = "neither key=value nor a file" not in told.err and "no such log" not in told.err
            assert told.status == 0 or not there, told.err
    assert list(tmp_path.iterdir()) == []


def test_version_anywhere() -> None:
    assert succeeds("train", "--version").out == f"placecue {__version__}\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_cfg_job_is_the_composed_config(command: str, tmp_path: Path) -> None:
    told = succeeds(command, *NEEDED.get(command, []), "--cfg", "job")
    config = yaml.safe_load(told.out)
    for word in NEEDED.get(command, []):
        key, value = word.split("=")
        assert config[key] == value or config[key]["plugin"] == value
    assert "hydra" not in config
    assert list(tmp_path.iterdir()) == []


def test_info_searchpath_shows_where_options_come_from(tmp_path: Path) -> None:
    told = succeeds("train", "--info", "searchpath")
    assert "pkg://placecue_conf" in told.out
    assert "component://" in told.out
    assert list(tmp_path.iterdir()) == []


def test_the_installed_script(tmp_path: Path) -> None:
    told = script("train", "--cfg", "job", "cue=laser", "log=x.mcap")
    assert told.status == 0, told.err
    assert list(yaml.safe_load(told.out)["cues"]) == ["laser"]
    told = script("tarin")
    assert told.status == 2
    assert "did you mean 'train'?" in told.line
    assert list(tmp_path.iterdir()) == []


def test_plugins_by_kind() -> None:
    listed = succeeds("plugins").out.splitlines()
    assert listed[0].split() == ["kind", "name", "summary", "distribution", "version", "status"]
    cues = [line.split() for line in succeeds("plugins", "kind=cue").out.splitlines()[1:]]
    assert cues == [line.split() for line in listed if line.startswith("cue ")]
    ours = {row[1] for row in cues if row[-3:] == ["placecue", __version__, "ok"]}
    assert ours >= {"crfh", "laser"}
    told = placecue("plugins", "kind=cuee")
    assert told.status == 2
    assert "did you mean 'cue'?" in told.line


def test_listing_what_is_installed_imports_nothing_that_trains() -> None:
    code = (
        "import sys; from placecue.cli import run; assert run(['plugins']) == 0; "
        "print(*(each for each in ('sklearn', 'scipy', 'mcap', 'cv2') if each in sys.modules))"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.splitlines()[-1] == ""


def test_a_terminal_of_few_letters(log_a: Path) -> None:
    few = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    told = script("info", str(log_a), **few)
    assert (told.status, told.err) == (0, "")
    assert "96 observations" in told.out
    assert told.out.isascii()


def test_something_is_said_before_anything_heavy_is_imported(log_a: Path) -> None:
    code = (
        "import sys; from placecue.commands.words import prepared; "
        f"prepared('train', [{str(log_a)!r}]); "
        "print(*(m for m in ('hydra', 'numpy', 'sklearn', 'mcap') if m in sys.modules))"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stderr.startswith(f"progress: train {log_a}, ")
    assert told.stderr.rstrip().endswith(" MB (mcap)")
    assert told.stdout.strip() == ""
