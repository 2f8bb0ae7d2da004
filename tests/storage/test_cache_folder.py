"""The cache outlives damage, killed runs and runs side by side, and is trimmed."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from caching import CALLS, REGISTRY, SAMPLES, Counting, extracted, same, shards
from placecue.learning.collecting import collect
from placecue.storage.cache_folder import contents, trim
from placecue.storage.feature_cache import FeatureCache
from toys import Walk


@pytest.fixture(autouse=True)
def _nothing_counted() -> None:
    CALLS.clear()


PROCESS = """
import os, sys
sys.path.insert(0, {tests!r})
import caching as t
from pathlib import Path

class Dying(t.Counting):
    def extract(self, observation):
        if t.CALLS["extract"] == int(sys.argv[2]):
            os._exit(9)
        return super().extract(observation)

Dying.__module__, Dying.__qualname__ = t.Counting.__module__, t.Counting.__qualname__
found = t.extracted(Path(sys.argv[1]), Dying("sparse"))
print(t.CALLS["extract"], found.sum())
"""


def process(folder: Path, dies_at: int = -1) -> subprocess.Popen[str]:
    code = PROCESS.format(tests=str(Path(__file__).parents[1]))
    words = [sys.executable, "-c", code, str(folder), str(dies_at)]
    return subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=dict(os.environ))


def test_a_killed_run_loses_no_more_than_one_file(tmp_path: Path) -> None:
    killed = process(tmp_path, 150)
    assert killed.wait() == 9
    out, _ = process(tmp_path).communicate()
    assert out.split()[0] == str(SAMPLES - 128)


def test_runs_side_by_side_share_the_cache(tmp_path: Path) -> None:
    running = [process(tmp_path) for _ in range(3)]
    answers = {each.communicate()[0].split()[1] for each in running}
    out, _ = process(tmp_path).communicate()
    assert out.split()[0] == "0"
    assert answers == {out.split()[1]} == {str(extracted(None, Counting("sparse")).sum())}


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def garbage(path: Path) -> None:
    path.write_bytes(b"PK\x03\x04" + bytes(range(256)) * 4)


def hostile(path: Path) -> None:
    class Bomb:
        def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
            return os.mkdir, (str(path.parent / "ran"),)

    arrays = dict(np.load(path))
    arrays["reasons"] = np.array([pickle.loads, Bomb()], dtype=object)
    np.savez(path, **arrays)


def encrypted(path: Path) -> None:
    """Set the flag of encryption in the last entry of the archive's directory."""
    data = bytearray(path.read_bytes())
    data[data.rindex(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(bytes(data))


def shortened(path: Path) -> None:
    """Let the header of an array say that it is smaller, which NumPy believes."""
    data = path.read_bytes()
    shape = b"'shape': (64, 3)" if b"'shape': (64, 3)" in data else b"'shape': (64,)"
    path.write_bytes(data.replace(shape, shape.replace(b"64", b"32")))


@pytest.mark.parametrize("spoil", [cut, garbage, hostile, encrypted, shortened])
def test_a_damaged_file_is_made_anew_and_never_run(
    spoil: Callable[[Path], None], tmp_path: Path
) -> None:
    first = extracted(tmp_path, Counting("sparse"))
    assert len(shards(tmp_path)) == 5
    spoil(shards(tmp_path)[1])
    assert same(first, extracted(tmp_path, Counting("sparse")))
    assert CALLS["extract"] == SAMPLES + 64
    assert not list(tmp_path.rglob("ran"))
    extracted(tmp_path, Counting("sparse"))
    assert CALLS["extract"] == SAMPLES + 64


def used(folder: Path, days: dict[str, float]) -> None:
    """Set when the features of each log were last used."""
    for each in contents(folder):
        seconds = each.used - 86_400 * days[each.about["log"]]
        os.utime(each.folder / "about.json", (seconds, seconds))


def test_trimming_takes_what_was_used_longest_ago(tmp_path: Path) -> None:
    for seed in range(3):
        extracted(tmp_path, Counting(), Walk(seed=seed))
    (tmp_path / "mine" / "own").mkdir(parents=True)
    (tmp_path / "mine" / "own" / "notes.txt").write_text("not placecue's")
    used(tmp_path, {"walk 0": 3, "walk 1": 1, "walk 2": 2})
    kept = contents(tmp_path)
    assert [each.about["log"] for each in kept] == ["walk 1", "walk 2", "walk 0"]
    assert [each.samples for each in kept] == [SAMPLES] * 3
    assert kept[0].about["changed"] == {}

    assert trim(tmp_path, unused_days=2.5) == kept[2].size
    assert [each.about["log"] for each in contents(tmp_path)] == ["walk 1", "walk 2"]
    assert trim(tmp_path, max_bytes=kept[0].size + 1) == kept[1].size
    assert [each.about["log"] for each in contents(tmp_path)] == ["walk 1"]
    assert trim(tmp_path, max_bytes=0) == kept[0].size
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["notes.txt"]


def test_a_run_trims_what_it_does_not_use(tmp_path: Path) -> None:
    extracted(tmp_path, Counting())
    [kept] = contents(tmp_path)
    used(tmp_path, {"walk 0": 1})
    with FeatureCache(tmp_path, REGISTRY, max_size=1.5 * kept.size / 1e9) as cache:
        collect(Walk(seed=1), {"cue": Counting()}, cache)
    assert [each.about["log"] for each in contents(tmp_path)] == ["walk 1"]
    extracted(tmp_path, Counting(), Walk(seed=1))
    assert CALLS["extract"] == 2 * SAMPLES


def test_runs_that_trim_side_by_side_do_not_fail(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from placecue.storage.cache_folder import *\n"
        "for number in range(400):\n"
        "    folder = Path(sys.argv[1]) / str(number % 7) / f'cue-{number % 3}'\n"
        "    describe(folder, {'log': 'a'}); trim(Path(sys.argv[1]), max_bytes=0)"
    )
    words = [sys.executable, "-c", code, str(tmp_path)]
    running = [subprocess.Popen(words, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    for each in running:
        told = each.communicate()[1]
        # Writing into a folder that was just removed is answered; nothing else may go wrong.
        assert each.returncode == 0 or "PlacecueError" in told or "cannot write" in told, told
        assert "scandir" not in told
