"""Tab completion: what is offered, and that a shell offers it."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from command_line import SCRIPT, placecue

BASH = shutil.which("bash")


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("placecue ", "demo train classify label convert info plugins"),
        ("placecue tra", "train"),
        ("placecue c", "classify convert"),
        ("placecue zzz", ""),
        ("placecue nope x", ""),
        ("placecue train cue=", "cue=crfh cue=laser"),
        ("placecue train cue=la", "cue=laser"),
        ("placecue train integrator=", "integrator=none integrator=svm_das"),
        ("placecue train log=a.mcap integ", "integration_log= integrator. integrator="),
        ("placecue train cue=laser cues.laser.pre", "cues.laser.preset="),
        ("placecue train -m cue=cr", "cue=crfh"),
        ("placecue convert source=", "source=carmen source=floorplan source=mcap source=office"),
        ("placecue label accumulator.bin", "accumulator.bin_theta= accumulator.bin_x="),
        ("placecue --no-plugins train cue=la", "cue=laser"),
        ("/home/train/bin/placecue train cue=la", "cue=laser"),
    ],
)
def test_what_is_offered(line: str, offered: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COMP_LINE", line)
    told = placecue("-sc", "query=bash")
    assert (told.status, told.err) == (0, "")
    assert set(offered.split()) <= set(told.out.split())
    if line.endswith("=") and offered:
        assert all(word.startswith(line.split()[-1]) for word in told.out.split())
    assert bool(told.out.strip()) == bool(offered)


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("placecue train log=ru", ["log=run1.mcap", "log=runs/"]),
        ("placecue train log=[run1.mcap,runs/", ["log=[run1.mcap,runs/a.bag"]),
        ("placecue info source.path=run1", ["source.path=run1.mcap"]),
        ("placecue info run1", ["run1.mcap"]),
        ("placecue train cue=[crfh,la", ["cue=[crfh,laser"]),
        ("placecue train cue=[crfh,cr", []),
    ],
)  # fmt: skip
def test_files_and_lists(
    line: str, offered: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "runs").mkdir()
    for name in ("run1.mcap", "runs/a.bag", ".runs"):
        (tmp_path / name).touch()
    monkeypatch.setenv("COMP_LINE", line)
    told = placecue("-sc", "query=bash")
    assert (told.status, told.err) == (0, "")
    assert told.out.split() == offered


@pytest.mark.skipif(BASH is None, reason="needs bash")
@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        (["placecue", "cla"], "classify"),
        (["placecue", "train", "cue=la"], "cue=laser"),
        (["placecue", "train", "cue=[crfh,la"], "cue=[crfh,laser"),
        (["placecue", "label", "boundaries@accumulator.boundary=no"], ""),
    ],
)
def test_in_bash(typed: list[str], offered: str) -> None:
    """Source what ``-sc install=bash`` prints and call the function that it completes by."""
    asked = f"""
        eval "$(placecue -sc install=bash)"
        COMP_WORDS=({" ".join(typed)}); COMP_CWORD={len(typed) - 1}
        COMP_LINE="{" ".join(typed)}"; COMP_POINT=${{#COMP_LINE}}
        function=$(complete -p placecue | grep -o -- '-F [^ ]*' | cut -d' ' -f2)
        $function 2>/dev/null
        echo "${{COMPREPLY[@]}}"
    """
    assert BASH is not None
    path = f"{SCRIPT.parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        [BASH, "--norc", "-c", asked],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "PATH": path},
        check=True,
    )
    assert done.stdout.strip() == offered


@pytest.mark.parametrize(
    ("request_", "said"),
    [("install=fish", "complete -c placecue"), ("uninstall=bash", "unset hydra_bash_completion")],
)
def test_other_requests(tmp_path: Path, request_: str, said: str) -> None:
    told = placecue("-sc", request_)
    assert (told.status, told.err) == (0, "")
    assert said in told.out
    assert list(tmp_path.iterdir()) == []
