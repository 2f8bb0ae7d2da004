"""Ctrl-C, and what else ends a command in the middle."""

from __future__ import annotations

import logging
import multiprocessing
import signal
import subprocess
import sys
import time
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from command_line import placecue, succeeds
from placecue.components.manager import current_plugins

#: A command that begins to write a file and is then busy for minutes.
COMMAND = """
import hashlib, signal, sys, threading, time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from placecue import cli
from placecue.atomic import replacing
from placecue.commands import plugins

def in_c():
    hashlib.pbkdf2_hmac("sha256", b"deaf", b"to signals", 10**9)

def run(config):
    with replacing(Path("out.txt")):
        print("begun", flush=True)
        {busy}

plugins.run = run
# Shells let commands in the background ignore it, and so would what they start.
signal.signal(signal.SIGINT, signal.default_int_handler)
cli.main(["plugins"])
"""
BUSY = {
    "in Python": "time.sleep(600)",
    "in C": "in_c()",
    "while a thread is in C": "threading.Thread(target=in_c).start(); time.sleep(600)",
    "waiting for a pool": "with ThreadPoolExecutor() as pool: pool.submit(in_c).result()",
}


@pytest.mark.parametrize("busy", BUSY)
def test_an_interrupt_ends_a_command(tmp_path: Path, busy: str) -> None:
    words = [sys.executable, "-c", COMMAND.format(busy=BUSY[busy])]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, cwd=tmp_path, **pipes) as process:  # type: ignore[call-overload]
        assert process.stdout.readline() == "begun\n"
        assert len(list(tmp_path.iterdir())) == 1
        process.send_signal(signal.SIGINT)
        try:
            _, complaint = process.communicate(timeout=30)  # of the 600 that it would take
        finally:
            process.kill()
    assert (process.returncode, complaint) == (130, "placecue: interrupted\n")
    assert list(tmp_path.iterdir()) == []


def interrupted(config: dict) -> None:
    raise KeyboardInterrupt("interrupted in extract of cue 'slow'")


def test_it_says_what_was_interrupted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("placecue.commands.plugins.run", interrupted)
    told = placecue("plugins")
    assert (told.status, told.line) == (130, "interrupted in extract of cue 'slow'")


@pytest.mark.parametrize("code", [0, 3, "done"])
def test_an_exit_in_the_middle_is_an_error(monkeypatch: pytest.MonkeyPatch, code: object) -> None:
    monkeypatch.setattr("placecue.commands.plugins.run", lambda config: sys.exit(code))  # type: ignore[arg-type]
    told = placecue("plugins")
    assert told.status == 1
    assert told.line.startswith(f"plugins broke off: something called sys.exit({code!r})")


def test_a_run_after_a_killed_one(tmp_path: Path, log_a: Path) -> None:
    """In the middle of a drive that takes far longer than it is given."""
    long = ["source=office", "source.rate=100", "source.width=64", "source.height=48"]
    words = [sys.executable, "-m", "placecue", "convert", *long, "out=out/a.mcap"]
    with subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.DEVNULL) as process:
        while process.poll() is None and not list(tmp_path.glob("out/.*.part")):
            time.sleep(0.1)
        process.kill()
    assert process.returncode == -signal.SIGKILL
    assert len(list((tmp_path / "out").iterdir())) == 1
    succeeds("convert", "source=mcap", f"log={log_a}", "out=out/b.mcap")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["b.mcap"]


def test_a_folder_with_nothing_but_parts_of_a_killed_run(tmp_path: Path, log_a: Path) -> None:
    (tmp_path / "out" / "search").mkdir(parents=True)
    code = (
        "import os, signal\nfrom pathlib import Path\nfrom placecue.atomic import replacing\n"
        "with replacing(Path('out/beliefs.csv')), replacing(Path('out/search/laser.md')):\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    killed = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert len(list((tmp_path / "out").rglob(".*.part"))) == 2
    train = ["cue=laser", "integrator=none", "cues.laser.classifier.search=null"]
    succeeds("train", *train, f"log={log_a}", "out=out")
    assert list((tmp_path / "out").rglob(".*")) == []


def written(out: Path) -> dict[str, bytes]:
    """Return what has its name in a folder, but for the report, which says when it was written."""
    found = [each for each in out.iterdir() if each.suffix in (".csv", ".json", ".mcap")]
    return {each.name: each.read_bytes() for each in found}


def test_killed_at_random_moments_nothing_is_half_written(
    tmp_path: Path, laser_model: Path, log_b: Path
) -> None:
    words = ["classify", laser_model, log_b, "cache.folder=null", "report=false"]
    began = time.perf_counter()
    succeeds(*words, "out=whole")
    took, due = time.perf_counter() - began, written(tmp_path / "whole")
    assert len(due) == 3
    fork, killed = multiprocessing.get_context("fork"), 0
    for moment in np.random.default_rng(12).uniform(0.05, 0.9, 4):
        child = fork.Process(target=placecue, args=(*words, "out=out", "overwrite=true"))
        child.start()
        child.join(moment * took)
        killed += child.is_alive()
        child.kill()
        child.join()
        left = written(tmp_path / "out") if (tmp_path / "out").is_dir() else {}
        assert left.items() <= due.items()
    assert killed
    succeeds(*words, "out=out", "overwrite=true")
    assert written(tmp_path / "out") == due
    assert list((tmp_path / "out").glob(".*")) == []


def test_every_plugin_is_heard(monkeypatch: pytest.MonkeyPatch) -> None:
    manager = current_plugins().manager
    manager.register(ModuleType("elsewhere.plugin"), name="elsewhere")
    modules = {each.module for each in entry_points(group="placecue")} | {"elsewhere.cues.slow"}

    def run(config: dict) -> None:
        for module in sorted(modules):
            logging.getLogger(module).warning(f"{module} has something to say")

    monkeypatch.setattr("placecue.commands.plugins.run", run)
    try:
        told = placecue("plugins")
    finally:
        manager.unregister(name="elsewhere")
        logging.getLogger("elsewhere").handlers = []
    said = [f"placecue: {module} has something to say" for module in sorted(modules)]
    assert told.err.splitlines() == said
