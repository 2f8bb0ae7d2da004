"""A plugin whose components misbehave: every command says so in one line that names them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import Distribution, EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from command_line import Told, placecue
from misbehaving import MISDEEDS, interrupt
from placecue import (
    Accumulator,
    Boundary,
    Component,
    Cue,
    Observation,
    Pose2D,
    SemanticMap,
    Source,
    hookimpl,
)
from placecue.components.manager import current_plugins
from placecue.logs import open_log

#: What every misbehaving component of this file does, set by each test.
DEED: list[Any] = []


#: What the plugin does when it is told of an observation.
LEAVING: list[Any] = []


def listening(observation: Any, belief: Any) -> None:
    for deed in LEAVING:
        deed()


class OddCue(Cue):
    """Does the deed."""

    requires = ("scan",)

    def extract(self, observation: Observation) -> Any:
        return DEED[0]()


class OddSource(Source):
    """Does the deed after one observation."""

    name = "odd.log"

    def __iter__(self) -> Iterator[Any]:
        yield Observation(7, pose=Pose2D(0.0, 0.0, 0.0))
        yield DEED[0]()

    def digest(self) -> str:
        return "odd"


class OddAccumulator(Accumulator):
    """Does the deed."""

    def update(self, observation: Observation, belief: Any) -> Any:
        return DEED[0]()

    def semantic_map(self) -> SemanticMap:
        return SemanticMap((), (), (), ())

    def reset(self) -> None:
        pass


class LastAccumulator(OddAccumulator):
    """Does the deed at the very end."""

    def update(self, observation: Observation, belief: Any) -> Any:
        return None

    def semantic_map(self) -> Any:
        return DEED[0]()


class OddBoundary(Boundary):
    """Does the deed."""

    def update(self, observation: Observation) -> Any:
        return DEED[0]()

    def reset(self) -> None:
        pass


class OddlyMade(OddCue):
    """Does the deed when it is made."""

    def __init__(self) -> None:
        DEED[0]()


COMPONENTS = [
    Component("cue", "odd", f"{__name__}:OddCue", "odd"),
    Component("cue", "oddly_made", f"{__name__}:OddlyMade", "odd"),
    Component("source", "odd", f"{__name__}:OddSource", "odd"),
    Component("accumulator", "odd", f"{__name__}:OddAccumulator", "odd"),
    Component("accumulator", "last", f"{__name__}:LastAccumulator", "odd"),
    Component("boundary", "odd", f"{__name__}:OddBoundary", "odd"),
]


class OddDistribution(Distribution):
    """Says that the plugin came with odd-things 1.2."""

    def read_text(self, filename: str) -> str | None:
        return "Name: odd-things\nVersion: 1.2\n" if filename == "METADATA" else None

    def locate_file(self, path: Any) -> Any:
        raise FileNotFoundError(path)


@pytest.fixture(autouse=True)
def _installed(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    module = ModuleType("odd_things")
    module.placecue_components = hookimpl(lambda: COMPONENTS)  # type: ignore[attr-defined]
    module.placecue_observation_classified = hookimpl(listening)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "odd_things", module)
    monkeypatch.setitem(sys.modules, __name__, _this_module())
    odd = EntryPoint("odd", "odd_things", "placecue")._for(OddDistribution())  # type: ignore[attr-defined]
    found = [*entry_points(group="placecue"), odd]
    monkeypatch.setattr(
        "placecue.components.manager.installed_entry_points", lambda group: (found, [])
    )
    current_plugins.cache_clear()
    yield
    current_plugins.cache_clear()
    DEED.clear()
    LEAVING.clear()


def _this_module() -> ModuleType:
    module = ModuleType(__name__)
    vars(module).update(globals())
    return module


def run(case: str, deed: Any, log: Path, model: Path) -> Told:
    """Run a command in which a component of ours does the deed."""
    DEED[:] = [deed]
    label = ["label", f"log={log}", f"model={model}", "out=labelled"]
    words = {
        "cue odd": ["train", "cue=odd", f"log={log}", "out=model"],
        "source odd": ["convert", "source=odd", "out=out.mcap"],
        "accumulator odd": [*label, "accumulator=odd"],
        "accumulator last": [*label, "accumulator=last"],
        "boundary odd": [*label, "boundaries@accumulator.boundary=odd"],
    }
    return placecue(*words[case])


CALLS = {
    "cue odd": "extract",
    "source odd": "iteration",
    "accumulator odd": "update",
    "accumulator last": "semantic_map",
    "boundary odd": "update",
}
WHERE = {
    "source odd": " at observation 1 of odd.log",
    "accumulator last": "",
}


@pytest.mark.parametrize("misdeed", ["raises", "leaves"])
@pytest.mark.parametrize("case", CALLS)
def test_what_it_does_wrong_is_one_line(
    case: str, misdeed: str, log_b: Path, laser_model: Path
) -> None:
    deed, told = MISDEEDS[misdeed]
    answer = run(case, deed, log_b, laser_model)
    kind, name = case.split()
    where = WHERE.get(case, f" at stamp {first_stamp(log_b)} of {log_b.name}")
    start = f"{kind} '{name}' (odd-things 1.2): {CALLS[case]} failed{where}: {told}"
    assert answer.line.startswith(start)
    assert answer.status == 1
    assert "should not happen" not in answer.err


@pytest.mark.parametrize("case", CALLS)
def test_ctrl_c_names_whom_it_stopped(case: str, log_b: Path, laser_model: Path) -> None:
    answer = run(case, interrupt, log_b, laser_model)
    kind, name = case.split()
    assert answer.line.startswith(
        f"interrupted in {CALLS[case]} of {kind} '{name}' (odd-things 1.2)"
    )
    assert answer.status == 130


@pytest.mark.parametrize("case", CALLS)
def test_nonsense_is_one_line(case: str, log_b: Path, laser_model: Path) -> None:
    answer = run(case, lambda: {"nonsense": np.nan}, log_b, laser_model)
    kind, name = case.split()
    said = f"{kind} '{name}' (odd-things 1.2): {CALLS[case]} returned a dict, not "
    assert answer.line.startswith(said)
    assert answer.status == 1


@pytest.mark.parametrize(
    ("misdeed", "said"),
    [
        ("raises", "refused its parameters: two lines"),
        ("leaves", "(odd-things 1.2) cannot be made: SystemExit: 3"),
        ("closes", "(odd-things 1.2) cannot be made: GeneratorExit"),
    ],
)
def test_one_that_cannot_be_made_is_one_line(misdeed: str, said: str, log_b: Path) -> None:
    DEED[:] = [MISDEEDS[misdeed][0]]
    answer = placecue("train", "cue=oddly_made", f"log={log_b}", "out=model")
    assert answer.line == f"cues.oddly_made: cue 'oddly_made' {said}"
    assert "should not happen" not in answer.err
    assert answer.status in (1, 2)


def test_a_listener_that_leaves_is_one_line(log_b: Path, laser_model: Path) -> None:
    DEED[:] = [lambda: None]
    LEAVING.append(MISDEEDS["leaves"][0])
    answer = placecue("classify", f"log={log_b}", f"model={laser_model}", "out=beliefs")
    said = "plugin odd-things:odd failed on observation_classified: SystemExit: 3"
    assert answer.line == said
    assert answer.status == 2


def first_stamp(log: Path) -> int:
    return next(iter(open_log(log))).stamp
