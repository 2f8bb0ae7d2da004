"""Broken records of other distributions hide nobody's plugins."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from placecue.compiled import KEY, give_place
from placecue.components.manager import load_plugins


@pytest.mark.parametrize(
    ("folder", "files"),
    [
        (".dist-info", {}),
        ("placecue-0.0.9.dist-info", {}),
        ("weird.egg-info", {"entry_points.txt": "[console_scripts]\nbroken line\n"}),
        (
            "bad-1.dist-info",
            {"METADATA": "Name: bad\nVersion: 1\n", "entry_points.txt": "[x]\nno\n"},
        ),
        ("raw-1.dist-info", {"METADATA": "\0\0"}),
    ],
)
def test_it_is_listed_and_the_rest_is_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str, files: dict[str, str]
) -> None:
    sound = len(list(load_plugins(built_ins_only=True).registry))
    (tmp_path / folder).mkdir()
    for name, text in files.items():
        (tmp_path / folder / name).write_text(text)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    loaded = load_plugins(built_ins_only=True).registry
    assert len(list(loaded)) == sound > 50
    (problem,) = [each for each in loaded.problems if str(tmp_path) in each.plugin]
    assert "\n" not in problem.error


def test_numba_is_given_a_place_only_where_it_finds_none(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    give_place(environment, [Path("/proc/nowhere"), tmp_path / "not/yet/there"])
    assert environment == {}
    give_place(environment, [Path("/proc/nowhere")])
    assert Path(environment[KEY]).is_dir()
    assert Path(environment[KEY]).stat().st_mode & 0o077 == 0  # code is run from it
    own = {"PLACECUE_CACHE": str(tmp_path)}
    give_place(own, [Path("/proc/nowhere")])
    assert own[KEY] == str(tmp_path / "compiled")
    named = {KEY: "elsewhere"}
    give_place(named, [Path("/proc/nowhere")])
    assert named == {KEY: "elsewhere"}
