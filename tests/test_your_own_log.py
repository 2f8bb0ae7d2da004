"""docs/your_own_log.md, command by command as it stands there."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from command_line import placecue

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "your_own_log.md").read_text(encoding="utf-8")
#: The camera is not looked at: small images save time.
SMALL = ["source.width=64", "source.height=48"]


def commands() -> list[list[str]]:
    return [shlex.split(line) for line in PAGE.splitlines() if line.startswith("    ")]


def test_from_a_bag_to_a_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PLACECUE_CACHE", str(tmp_path / "cache"))
    said = []
    for program, *words in commands():
        if program == "python":
            subprocess.run([sys.executable, *words], check=True, capture_output=True)
            continue
        told = placecue(*words, *(SMALL if "source=office" in words else []))
        assert told.status == 0, told.err
        said.append(told.out)
    assert len(said) == len(commands()) - 2
    by_rooms, by_time = [each for each in said if "the way, " in each][1:3]
    for each in (by_rooms, by_time):
        share = re.search(r"observations, ([\d.]+) % with a label", each)
        assert share is not None
        assert float(share[1]) > 90
        assert "  corridor: " in each
    found = json.loads((tmp_path / "labelled" / "semantic_map.json").read_text())
    rooms = json.loads((ROOT / "examples" / "your_own_log" / "rooms.geojson").read_text())
    classes = {feature["properties"]["class"] for feature in rooms["features"]}
    labels = {area["label"] for area in found["areas"]} - {"unknown"}
    assert "corridor" in labels
    assert len(labels) >= 3
    assert labels <= classes
    assert "messages copied as they are" in said[-1]


def test_every_file_that_the_page_names_is_there() -> None:
    for path in re.findall(r"\]\(\.\./([^)]+)\)", PAGE):
        assert (ROOT / path).is_file()
