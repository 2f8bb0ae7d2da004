"""What commands say about themselves, without doing anything."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from command_line import SCRIPT, placecue, script, succeeds
from placecue import __version__
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
def test_help_of_a_command_shows_its_config(command: str) -> None:
    required = ["source=carmen"] if command == "convert" else []
    told = succeeds(command, *required, "--help")
    assert told.out.startswith(f"placecue {command} [key=value ...] [options]")
    assert "--cfg job" in told.out
    assert "Powered by Hydra" not in told.out


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
