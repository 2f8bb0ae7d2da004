"""Features are extracted once, however a run ends and whoever runs beside it."""

from __future__ import annotations

import logging
import os
import pickle
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse

import toys
from placecue import Cue, Observation, UnusableObservation
from placecue.features import DescriptorSets
from placecue.samples import collect
from placecue.storage.cache_folder import contents, trim
from placecue.storage.feature_cache import FeatureCache
from toys import Brightness, Walk

REGISTRY = toys.registry()
CALLS: Counter[str] = Counter()
SAMPLES = 4 * 20 * 4


@pytest.fixture(autouse=True)
def _nothing_counted() -> None:
    CALLS.clear()


class Counting(Cue):
    """The beams as features of any kind; counts what it is asked for."""

    requires = ("scan",)

    def __init__(self, kind: str = "dense", factor: float = 1.0) -> None:
        self.kind = kind
        self.factor = factor

    def extract(self, observation: Observation) -> object:
        CALLS["extract"] += 1
        assert observation.scan is not None
        beams = self.factor * observation.scan.filled()
        if self.kind == "sparse":
            return sparse.csr_array(np.where(beams > 3, beams, 0)[None])
        if self.kind == "descriptors":
            return beams[: int(beams[0] * 2)].reshape(-1, 1).repeat(3, axis=1).astype(np.float32)
        return beams


class Picky(Counting):
    """Cannot use every third scan."""

    def extract(self, observation: Observation) -> object:
        if observation.stamp // (toys.SECOND // 5) % 3 == 0:
            CALLS["extract"] += 1
            raise UnusableObservation(f"nothing to see at {observation.stamp}")
        return super().extract(observation)


class Learning(Brightness):
    """Counts how often it learns and looks."""

    def fit(self, observations, labels=None):  # type: ignore[no-untyped-def]
        CALLS["fit"] += 1
        return super().fit(observations, labels)

    def extract(self, observation: Observation) -> np.ndarray:
        CALLS["extract"] += 1
        return super().extract(observation)


def extracted(folder: Path | None, cue: Cue, log: Walk | None = None) -> object:
    """The features of a walk, through a cache of its own or without one."""
    log = Walk() if log is None else log
    if folder is None:
        return collect(log, {"cue": cue}).extracted["cue"].features
    with FeatureCache(folder, REGISTRY) as cache:
        return collect(cache.following(log), {"cue": cue}, cache).extracted["cue"].features


def same(a: object, b: object) -> bool:
    if isinstance(a, DescriptorSets):
        assert isinstance(b, DescriptorSets)
        return np.array_equal(a.offsets, b.offsets) and same(a.values, b.values)
    if sparse.issparse(a):
        return same(a.toarray(), b.toarray()) and a.nnz == b.nnz
    return a.dtype == b.dtype and np.array_equal(a, b)


@pytest.mark.parametrize("kind", ["dense", "sparse", "descriptors"])
def test_a_second_run_extracts_nothing(kind: str, tmp_path: Path) -> None:
    fresh = extracted(None, Counting(kind))
    CALLS.clear()
    first = extracted(tmp_path, Counting(kind))
    assert CALLS["extract"] == SAMPLES
    again = extracted(tmp_path, Counting(kind))
    assert CALLS["extract"] == SAMPLES
    assert same(fresh, first)
    assert same(fresh, again)


def test_neither_does_classifying_a_log_again(tmp_path: Path) -> None:
    pipeline = toys.pipeline().fit(Walk())
    plain = [belief.scores.values for belief in pipeline.beliefs(Walk(seed=1), batch=16)]
    for batch in (16, 7):
        with FeatureCache(tmp_path, REGISTRY) as pipeline.extraction:
            log = pipeline.extraction.following(Walk(seed=1))
            beliefs = list(pipeline.beliefs(log, batch))
        values = [belief.scores.values for belief in beliefs]
        np.testing.assert_allclose(values, plain, rtol=0, atol=1e-12)
        # What would not come from the cache fails from now on.
        pipeline.cues["beams"][0].extract = pipeline.cues["brightness"][0].extract = None


def test_what_a_cue_learns_is_kept_for_every_fold(tmp_path: Path) -> None:
    folds = [np.arange(0, 200), np.arange(100, SAMPLES)]

    def learned() -> list[object]:
        with FeatureCache(tmp_path, REGISTRY) as cache:
            samples = collect(cache.following(Walk()), {"cue": Learning()}, cache)
            return [samples.learned_from("cue", Learning(), rows).features for rows in folds]

    first = learned()
    assert CALLS == {"fit": 2, "extract": 2 * SAMPLES}
    again = learned()
    assert CALLS == {"fit": 2, "extract": 2 * SAMPLES}
    assert all(map(same, first, again))
    assert not same(*first)
    plain = collect(Walk(), {"cue": Learning()})
    assert same(first[0], plain.learned_from("cue", Learning(), folds[0]).features)


def test_another_version_parameter_or_log_is_extracted_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    extracted(tmp_path, Counting())
    doubled = extracted(tmp_path, Counting(factor=2.0))
    assert CALLS["extract"] == 2 * SAMPLES
    assert same(doubled, extracted(None, Counting(factor=2.0)))
    CALLS.clear()
    extracted(tmp_path, Counting(), Walk(seed=1))
    assert CALLS["extract"] == SAMPLES
    monkeypatch.setattr(Counting, "version", "2")
    extracted(tmp_path, Counting())
    assert CALLS["extract"] == 2 * SAMPLES


def test_a_digest_that_says_too_little_does_no_harm(tmp_path: Path) -> None:
    class Later(Walk):
        def at(self, number: int) -> Observation:
            each = super().at(number)
            return Observation(each.stamp + 1, scan=each.scan, label=each.label)

    extracted(tmp_path, Counting())
    extracted(tmp_path, Counting(), Later())
    assert CALLS["extract"] == 2 * SAMPLES


def test_what_was_unusable_stays_so(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    first = extracted(tmp_path, Picky())
    said = caplog.text
    assert "107 of 320 observations passed over; the first: nothing to see at 0" in said
    caplog.clear()
    assert same(first, extracted(tmp_path, Picky()))
    assert caplog.text == said
    assert CALLS["extract"] == SAMPLES


def test_an_interrupted_run_goes_on_where_it_was(tmp_path: Path) -> None:
    class Interrupted(Walk):
        def at(self, number: int) -> Observation:
            if number == 150:
                raise KeyboardInterrupt
            return super().at(number)

    with pytest.raises(KeyboardInterrupt):
        extracted(tmp_path, Counting(), Interrupted())
    assert CALLS["extract"] == 150
    extracted(tmp_path, Counting())
    assert CALLS["extract"] == SAMPLES


PROCESS = """
import os, sys
sys.path[:0] = [{tests!r}, {here!r}]
import test_feature_cache as t
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
    here = Path(__file__).parent
    code = PROCESS.format(tests=str(here.parent), here=str(here))
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


def shards(folder: Path) -> list[Path]:
    return sorted(folder.glob("*/*/*.npz"))


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


def test_a_folder_that_cannot_be_written_costs_a_warning(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file")
    with caplog.at_level(logging.WARNING):
        found = extracted(taken, Counting())
    assert same(found, extracted(None, Counting()))
    [record] = caplog.records
    assert f"the feature cache {taken} cannot be written" in record.message
    assert "cache.folder=null" in record.message


def test_observations_of_no_log_are_extracted_as_ever(tmp_path: Path) -> None:
    with FeatureCache(tmp_path, REGISTRY) as cache:
        for _ in range(2):
            collect(list(Walk()), {"cue": Counting()}, cache)
    assert CALLS["extract"] == 2 * SAMPLES
    assert not shards(tmp_path)


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
        collect(cache.following(Walk(seed=1)), {"cue": Counting()}, cache)
    assert [each.about["log"] for each in contents(tmp_path)] == ["walk 1"]
    extracted(tmp_path, Counting(), Walk(seed=1))
    assert CALLS["extract"] == 2 * SAMPLES


class Named(Walk):
    """A log whose digest is text, as a plugin's might be."""

    def digest(self) -> str:
        return f"../learned/simulated walk of a robot number {self.seed}"


def test_digests_that_begin_alike_are_told_apart(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    first, second = (extracted(cache, Counting(), Named(seed=seed)) for seed in (0, 1))
    assert CALLS["extract"] == 2 * SAMPLES
    assert not same(first, second)
    assert [path.name for path in tmp_path.iterdir()] == ["cache"]


def test_what_failed_in_reading_may_not_fail_again(tmp_path: Path) -> None:
    class Unreadable(Walk):
        broken = True

        def at(self, number: int) -> Observation:
            each = super().at(number)
            if not self.broken or number % 4:
                return each

            def fails() -> np.ndarray:
                raise UnusableObservation("Input/output error")

            return Observation(each.stamp, image=fails, scan=each.scan, label=each.label)

    def usable() -> int:
        cue = Learning()
        cue.learns, cue.center_ = False, np.zeros(3)  # type: ignore[misc]
        return len(extracted(tmp_path, cue, Unreadable()))

    assert usable() == SAMPLES * 3 // 4
    Unreadable.broken = False
    assert usable() == SAMPLES


def test_each_log_is_written_when_the_next_begins(tmp_path: Path) -> None:
    with FeatureCache(tmp_path, REGISTRY) as cache:
        for seed in range(3):
            log = cache.following(Walk(rounds=1, stay=5, seed=seed))
            collect(log, {"cue": Counting()}, cache)
            assert len(shards(tmp_path)) == seed
    assert len(shards(tmp_path)) == 3


def test_a_cue_changed_in_place_is_another(tmp_path: Path) -> None:
    class Listed(Counting):
        def __init__(self, factors: list[float]) -> None:
            self.factors = factors

        def extract(self, observation: Observation) -> object:
            self.kind, self.factor = "dense", sum(self.factors)
            return super().extract(observation)

    with FeatureCache(tmp_path, REGISTRY) as cache:
        log, cue = cache.following(Walk()), Listed([1.0])
        first = collect(log, {"cue": cue}, cache).extracted["cue"].features
        cue.factors.append(1.0)
        second = collect(log, {"cue": cue}, cache).extracted["cue"].features
    np.testing.assert_allclose(second, 2 * first)


def test_a_cue_that_no_key_can_be_made_of_is_not_kept(tmp_path: Path) -> None:
    cue = Counting(factor=1.0)
    cue.kind = lambda: None  # type: ignore[assignment]
    for _ in range(2):
        extracted(tmp_path, cue)
    assert CALLS["extract"] == 2 * SAMPLES
    assert not shards(tmp_path)


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
