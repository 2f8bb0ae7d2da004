"""``placecue live``: a robot is followed until Ctrl-C, and the map is that of its log."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from command_line import placecue
from placecue.interrupting import stopped_by_interrupt
from results import rows
from robots import SERVED, followed_live, recorded, robot

BELIEF, AREA, MAP = SERVED


def test_it_comes_to_what_label_comes_to(
    tmp_path: Path, laser_model: Path, log_b: Path, labelled: Path
) -> None:
    """Beliefs, map and what is served; Ctrl-C once all has come."""
    out, expected = tmp_path / "live", rows(labelled / "beliefs.csv")
    with robot(recorded(log_b)) as sends:
        told, served = followed_live(
            *(sends, ("/scan", "/odom", "/label"), len(expected) - 1),  # the last waits for a pose
            *(str(laser_model), f"out={out}"),
        )
    assert told.status == 0, told.err
    assert "dropped, as labelling did not keep up: 0 observations, 0 messages" in told.out
    assert "balanced accuracy" in told.out
    assert rows(out / "beliefs.csv") == expected
    name = "semantic_map.json"
    assert json.loads((out / name).read_text()) == json.loads((labelled / name).read_text())
    assert [(b["stamp"], b["label"]) for b in served[BELIEF]] == [
        (int(row["stamp"]), row["label"]) for row in expected[: len(served[BELIEF])]
    ]
    assert served[AREA][0]["area"] == 0
    assert set(served[MAP][0]) == set(json.loads((out / name).read_text()))


def test_options_are_looked_at_first(tmp_path: Path, laser_model: Path, log_b: Path) -> None:
    wrong = {
        "serve=3": "serve must be true or false",
        "port=70000": "port is 70000",
        "workers=0": "workers is 0",
        "seconds=0": "seconds is 0",
        "map_every=0": "map_every is 0",
    }
    address = "ws://127.0.0.1:1"
    for word, complaint in wrong.items():
        told = placecue("live", address, f"model={laser_model}", word, f"out={tmp_path / 'out'}")
        assert told.status == 2
        assert complaint in told.line
    told = placecue("live", str(log_b), f"model={laser_model}")
    assert "is no address of a server" in told.line
    told = placecue("live", f"model={laser_model}")
    assert "nothing to read" in told.line


def test_a_port_that_is_taken(tmp_path: Path, laser_model: Path, log_b: Path) -> None:
    with robot(recorded(log_b)) as other:
        for words in (["serve=true", "port"], ["serve=false", "view=true", "view_port"]):
            words[-1] += f"={other.port}"
            told = placecue("live", "ws://127.0.0.1:1", f"model={laser_model}", *words)
            assert told.status == 2
            assert f"127.0.0.1:{other.port}" in told.line
            assert f"give another {words[-1].partition('=')[0]}=" in told.line


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Where the tests run behind a shell that ignores SIGINT, Python would too."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_the_first_interrupt_stops_and_the_second_ends(interruptible: None) -> None:
    stopped: list[str] = []
    with stopped_by_interrupt(lambda: stopped.append("once")):
        signal.raise_signal(signal.SIGINT)
        assert stopped == ["once"]
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    with stopped_by_interrupt(lambda: stopped.append("never")):
        pass
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    assert stopped == ["once"]
