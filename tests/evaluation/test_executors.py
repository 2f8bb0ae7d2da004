"""Tasks run the same wherever they run, and none stops the others."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import count, islice
from pathlib import Path

import joblib
import pytest

from placecue.errors import DataError, PlacecueError, UsageError
from placecue.evaluation.executors.backends import BACKENDS, executor_of
from tasks import may_fail, spectrum, threads

EXECUTORS = {
    "none": {"name": "none"},
    "threads": {"name": "threads", "jobs": 2},
    "loky": {"name": "loky", "jobs": 2},
    "dask": {"name": "dask", "address": None, "workers": 2},
}
PROCESSES = ("loky", "dask")
TESTS = Path(__file__).parents[1]


@pytest.fixture(autouse=True)
def _workers_import_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(TESTS))


def config(name: str) -> dict:
    if name == "dask":
        pytest.importorskip("distributed", reason="executor=dask needs placecue[dask]")
    return {"executor": EXECUTORS[name]}


@pytest.fixture(scope="module")
def spectra() -> dict[int, bytes]:
    with executor_of({}) as executor:
        return {each.task: each.value for each in executor.map(spectrum, range(6))}  # type: ignore[misc]


@pytest.mark.parametrize("name", EXECUTORS)
def test_results_are_the_same_to_the_bit(name: str, spectra: dict[int, bytes]) -> None:
    with executor_of(config(name)) as executor:
        found = {each.task: each.value for each in executor.map(spectrum, range(6))}
    assert found == spectra


@pytest.mark.parametrize("name", EXECUTORS)
def test_one_thread_a_worker(name: str) -> None:
    with executor_of(config(name)) as executor:
        [outcome] = executor.map(threads, [0])
    assert set(outcome.value or ()) == {1}


@pytest.mark.parametrize("name", EXECUTORS)
def test_a_task_that_fails_does_not_stop_the_rest(name: str) -> None:
    tasks = ["a", "no log", "b", "foreign", "leave", "c"]
    with executor_of(config(name)) as executor:
        found = {each.task: each for each in executor.map(may_fail, tasks)}
    assert {each: found[each].value for each in "abc"} == {"a": "A", "b": "B", "c": "C"}
    failed = {task: found[task].error for task in tasks if found[task].error}
    assert {task: str(error) for task, error in failed.items()} == {
        "no log": "no such log: a.mcap",
        "foreign": "ValueError: two lines",
        "leave": "SystemExit: 3",
    }
    assert isinstance(failed["no log"], DataError)
    assert "in may_fail" in str(failed["foreign"].__cause__)  # type: ignore[union-attr]


@pytest.mark.parametrize("name", PROCESSES)
def test_a_worker_that_dies_loses_its_own_task_only(name: str) -> None:
    tasks = ["a", "b", "killed", *"cdefgh", "unpicklable", "i"]
    with executor_of(config(name)) as executor:
        found = {each.task: each for each in executor.map(may_fail, tasks)}
    assert set(found) == set(tasks)
    good = {task: each.value for task, each in found.items() if each.error is None}
    assert good == {task: task.upper() for task in "abcdefghi"}
    assert str(found["killed"].error).startswith("its worker died")
    assert "pickle" in str(found["unpicklable"].error)
    assert "\n" not in str(found["unpicklable"].error)


@pytest.mark.parametrize("name", EXECUTORS)
def test_tasks_are_taken_as_they_are_needed(name: str) -> None:
    """Of tasks without end, so that taking them all would never come to one."""
    taken = []

    def tasks() -> Iterator[str]:
        for number in count():
            taken.append(number)
            yield str(number)

    with executor_of(config(name)) as executor:
        outcomes = executor.map(may_fail, tasks())
        first = list(islice(outcomes, 3))
        outcomes.close()  # type: ignore[attr-defined]
    assert len({each.value for each in first}) == 3
    assert set(range(3)) <= set(taken)


@pytest.mark.parametrize("name", EXECUTORS)
def test_tasks_that_break_off(name: str) -> None:
    def tasks() -> Iterator[str]:
        yield from "abc"
        raise DataError("the list of logs ends in the middle")

    found = []
    with executor_of(config(name)) as executor:
        outcomes = executor.map(may_fail, tasks())
        found += [each.value for each in islice(outcomes, 3)]
        with pytest.raises(DataError, match="ends in the middle"):
            next(outcomes)
    assert sorted(found) == ["A", "B", "C"]


@pytest.mark.parametrize(
    ("chosen", "said"),
    [
        ({"name": "lokky"}, "unknown executor 'lokky'; did you mean 'loky'?"),
        ({"name": "loky", "jobs": 0}, "executor.jobs cannot be 0: give a number from 1"),
        ({"name": "threads", "jobs": True}, "executor.jobs cannot be True"),
        ({"name": "dask", "address": None, "workers": "two"}, "executor.workers cannot be 'two'"),
    ],
)
def test_a_wrong_choice(chosen: dict, said: str) -> None:
    if chosen["name"] == "dask":
        pytest.importorskip("distributed", reason="executor=dask needs placecue[dask]")
    with pytest.raises(UsageError) as refused, executor_of({"executor": chosen}):
        pass
    assert str(refused.value).startswith(said)


def test_a_bare_name() -> None:
    with executor_of({"executor": "threads"}) as executor:
        assert (executor.name, executor.jobs) == ("threads", joblib.cpu_count())


@pytest.mark.parametrize(("name", "package"), [("dask", "distributed"), ("ray", "ray")])
def test_what_is_not_installed(name: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("placecue.evaluation.executors.backends.find_spec", lambda found: None)
    with pytest.raises(UsageError) as refused, executor_of({"executor": {"name": name}}):
        pass
    assert str(refused.value) == (
        f"executor={name} needs {package}, which is not installed: "
        f"pip install 'placecue[{name}]', or choose executor=loky"
    )


def test_a_scheduler_that_is_not_there() -> None:
    pytest.importorskip("distributed", reason="executor=dask needs placecue[dask]")
    import dask

    chosen = {"name": "dask", "address": "tcp://127.0.0.1:1"}
    with (
        dask.config.set({"distributed.comm.timeouts.connect": "100ms"}),
        pytest.raises(PlacecueError, match=r"executor\.address=tcp://127\.0\.0\.1:1 answers not"),
        executor_of({"executor": chosen}),
    ):
        pass


#: A command whose two workers are busy for minutes.
COMMAND = """
import signal, sys
from placecue import cli
from placecue.commands import plugins
from placecue.evaluation.executors.backends import executor_of
from tasks import sleep_long

def run(config):
    with executor_of({{"executor": {chosen}}}) as executor:
        list(executor.map(sleep_long, ["."] * 4))

if __name__ == "__main__":
    plugins.run = run
    signal.signal(signal.SIGINT, signal.default_int_handler)
    cli.main(["plugins"])
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize("name", PROCESSES)
def test_no_worker_is_left_behind(tmp_path: Path, name: str, number: signal.Signals) -> None:
    chosen = config(name)["executor"]
    script = tmp_path / "command.py"
    script.write_text(COMMAND.format(chosen=chosen))
    words = [sys.executable, str(script)]
    with subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        while process.poll() is None and len(workers := _workers(tmp_path)) < 2:
            time.sleep(0.1)
        process.send_signal(number)
        try:
            _, complaint = process.communicate(timeout=60)
        finally:
            process.kill()
    if number is not signal.SIGKILL:
        assert process.returncode == 130
        assert complaint.startswith("placecue: ")
    while any(map(_lives, workers)):  # of the ten minutes that they would take
        time.sleep(0.1)


def _workers(folder: Path) -> list[int]:
    return [int(each.name) for each in folder.iterdir() if each.name.isdigit()]


def _lives(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_each_has_an_option() -> None:
    from importlib.resources import files

    options = {each.name for each in (files("placecue_conf") / "executor").iterdir()}
    assert options == {f"{name}.yaml" for name in BACKENDS}
