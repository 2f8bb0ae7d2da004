"""The cue of docs/your_own_cue.md is what the example holds, and does what it says."""

from __future__ import annotations

import importlib.util
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from placecue import LaserScan, Observation, UsageError

ROOT = Path(__file__).parents[2]
FILE = ROOT / "examples" / "your_own_cue" / "placecue_openness.py"


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> types.ModuleType:
    spec = importlib.util.spec_from_file_location("placecue_openness", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "placecue_openness", module)
    spec.loader.exec_module(module)
    return module


def test_the_page_shows_it_whole() -> None:
    page = (ROOT / "docs" / "your_own_cue.md").read_text(encoding="utf-8")
    assert f"```python\n{FILE.read_text(encoding='utf-8').strip()}\n```" in page


def test_rings_of_a_worked_scan(example: types.ModuleType) -> None:
    # Four rings, the last from 9 m: two beams in [0, 3), one in [3, 6), one that sees nothing.
    ranges = np.array([1.0, 2.9, 4.0, np.inf])
    scan = LaserScan(np.linspace(-1, 1, 4), ranges, 0.1, 30.0)
    cue = example.Openness(rings=4, farthest=9.0)
    np.testing.assert_allclose(cue.extract(Observation(0, scan=scan)), [0.5, 0.25, 0, 0.25])
    with pytest.raises(UsageError, match="rings >= 2"):
        example.Openness(rings=1).check_parameters()


def test_its_component_is_found(example: types.ModuleType) -> None:
    [component] = example.placecue_components()
    module, _, name = component.factory.partition(":")
    assert module == FILE.stem
    assert getattr(example, name)() is not None
