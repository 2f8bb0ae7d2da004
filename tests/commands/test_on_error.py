"""``on_error=``: what becomes of an observation that a component fails on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from command_line import placecue
from placecue.errors import PlacecueError


def words_for(command: str, log: Path, model: Path) -> list[str]:
    if command == "train":
        return ["train", "cue=laser", "integrator=none", f"log={log}", "out=out"]
    return [command, f"model={model}", f"log={log}", "out=out"]


@pytest.mark.parametrize("command", ["train", "classify", "label"])
@pytest.mark.parametrize(("word", "expected"), [([], "stop"), (["on_error=skip"], "skip")])
def test_it_reaches_the_pipeline(
    command: str,
    word: list[str],
    expected: str,
    log_a: Path,
    laser_model: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def reached(pipeline: Any, *_: Any, **__: Any) -> None:
        raise PlacecueError(f"reached with {pipeline.on_error}")

    monkeypatch.setattr("placecue.pipeline.Pipeline.fit", reached)
    for name in ("classify", "label"):
        monkeypatch.setattr(f"placecue.commands.{name}.run_log", reached)
    told = placecue(*words_for(command, log_a, laser_model), *word)
    assert told.line == f"reached with {expected}"


@pytest.mark.parametrize("command", ["train", "classify", "label", "demo"])
def test_another_word_is_refused_at_once(command: str, log_a: Path, laser_model: Path) -> None:
    words = ["demo", "out=out"] if command == "demo" else words_for(command, log_a, laser_model)
    told = placecue(*words, "on_error=skp")
    assert (told.status, told.out) == (2, "")
    assert told.line == "on_error is 'skp'; did you mean 'skip'? available: skip, stop"
    assert not Path("out").exists()
