"""Runs the command line inside the tests' process, and as the installed script."""

from __future__ import annotations

import io
import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path

from hydra.core.global_hydra import GlobalHydra

from placecue.cli import run

SCRIPT = Path(sys.executable).with_name("placecue")


@dataclass(frozen=True)
class Told:
    """What a command answered."""

    status: int
    out: str
    err: str

    @property
    def line(self) -> str:
        """The one line on standard error, without who says it."""
        [line] = self.err.split("\n")[:-1] or [""]
        assert line.startswith("placecue: "), self.err
        return line.removeprefix("placecue: ")


def placecue(*words: str) -> Told:
    """Run a command line in this process."""
    out, err = io.StringIO(), io.StringIO()
    GlobalHydra.instance().clear()
    with _as_it_was(), redirect_stdout(out), redirect_stderr(err):
        status = run([str(word) for word in words])
    return Told(status, out.getvalue(), _without_progress(err.getvalue()))


def script(*words: str, **environment: str) -> Told:
    """Run the installed script as a process of its own."""
    done = subprocess.run(
        [SCRIPT, *words],
        capture_output=True,
        text=True,
        timeout=600,
        env={**os.environ, **environment},
        check=False,
    )
    return Told(done.returncode, done.stdout, _without_progress(done.stderr))


def _without_progress(err: str) -> str:
    """Leave out what a command says every ten seconds, which a slow machine may come to."""
    lines = err.splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith("progress: "))


def succeeds(*words: str) -> Told:
    """Run a command that has nothing to complain of."""
    told = placecue(*words)
    assert (told.status, told.err) == (0, ""), told.err
    return told


def installed(python: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run placecue as the Python of another environment sees it."""
    return subprocess.run(
        [python, "-m", "placecue", *words],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, **environment},
        check=False,
    )


@contextmanager
def _as_it_was() -> Iterator[None]:
    """Undo what a command does to the process: its loggers, its arguments, its environment."""
    packages = {each.module.partition(".")[0] for each in entry_points(group="placecue")}
    loggers = {name: logging.getLogger(name) for name in packages}
    before = {name: (each.handlers, each.propagate, each.level) for name, each in loggers.items()}
    arguments, environment = sys.argv, dict(os.environ)
    try:
        yield
    finally:
        for name, (handlers, propagate, level) in before.items():
            loggers[name].handlers, loggers[name].propagate = handlers, propagate
            loggers[name].setLevel(level)
        sys.argv = arguments
        os.environ.clear()
        os.environ.update(environment)
