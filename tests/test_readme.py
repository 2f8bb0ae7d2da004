"""What the README says, run as it stands there."""

import re
import shlex
from pathlib import Path

import pytest

from placecue.commands.names import COMMANDS
from placecue.logs.writing.convert import copy
from placecue.logs.writing.writer import McapWriter
from placecue_office.simulator import Office

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_library_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for run in (1, 2):
        source = Office(run=run, rate=1.0, width=80, height=60)
        with McapWriter(f"run{run}.mcap") as writer:
            written = copy(source, writer)
    [example] = re.findall(
        r"```python\n(from placecue import [^\n]*Pipeline\n.*?)```", README, re.DOTALL
    )
    exec(compile(example, "README.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == written
    assert all(line.endswith("('crfh', 'laser')") for line in lines)


def test_every_command_in_the_readme_is_one() -> None:
    lines = [line.strip() for line in README.splitlines() if line.startswith("    ")]
    words = [shlex.split(line, comments=True) for line in lines if "placecue " in line]
    used = [each[each.index("placecue") + 1] for each in words if "placecue" in each]
    assert len(used) > 10
    assert set(used) - {"COMMAND"} <= set(COMMANDS)


def test_every_page_that_the_readme_names_is_there() -> None:
    for page in re.findall(r"\]\(([^):]+)\)", README):
        assert (ROOT / page).is_file(), page


def test_every_file_that_the_architecture_page_names_is_there() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    named = re.findall(r"`((?:[\w.]+/)*\w+(?:\.py|/))`", page)
    assert len(named) > 40
    roots = [ROOT, ROOT / "core" / "placecue", *(ROOT / "plugins").glob("*/placecue_*")]
    for path in named:
        assert any((root / path).exists() for root in roots), path
