"""Inputs of many kinds, spoilt: a few seeded cases of each; ``fuzzing.py`` runs any number."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

COUNT = 240  # in all; a process of its own, for an alarm ends what hangs


@pytest.mark.parametrize("seed", [1])
def test_nothing_foreign_nothing_hangs_nothing_is_lost(seed: int) -> None:
    script = Path(__file__).with_name("fuzzing.py")
    done = subprocess.run(
        [sys.executable, str(script), str(COUNT), str(seed)],
        capture_output=True,
        text=True,
        check=True,
    )
    told = json.loads(done.stdout)
    assert sum(told["cases"].values()) == COUNT
    assert len(told["cases"]) == 6
    assert sum(told["refused"].values()) < COUNT  # most can be read after all
    for wrong in ("foreign", "slow", "lost before", "silent"):
        assert told[wrong] == []
