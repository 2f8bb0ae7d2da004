"""Tampered model folders are refused in one line; nothing runs, nothing is written."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

FOLDERS = 150


def test_nothing_runs_and_nothing_foreign_is_raised() -> None:
    script = Path(__file__).with_name("tampering.py")
    done = subprocess.run(
        [sys.executable, "-B", str(script), str(FOLDERS), "0"],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["foreign_at_load"] == {}
    assert found["foreign_at_believe"] == {}
    assert found["acts"] == {}
    assert not found["marker"]
    assert found["peak"] < 500
    assert found["outcomes"]["refused at load"] > FOLDERS / 2
    assert found["outcomes"]["believed"] > 0
