"""Tampers with model folders in many ways and loads them, watching what happens.

``python tampering.py COUNT SEED`` prints as JSON what became of COUNT folders: how many were
refused and how many loaded, every exception that was not placecue's, everything that was run,
imported or written while loading and believing, and the peak of memory.
"""

from __future__ import annotations

import json
import os
import random
import re
import shutil
import signal
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from tamperings import ARRAYS_TAMPERINGS, FILE_TAMPERINGS, JSON_TAMPERINGS, write_very_much

from folders import reseal
from placecue import Pipeline, PlacecueError, StandardScaling, Unknown
from placecue.storage.model import load_model, save_model
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from toys import Beams, Walk, pipeline, registry

#: Packages that loading may import: our own, and what computes.
KNOWN = {
    *("placecue", "placecue_cues", "placecue_classifiers", "placecue_kernels", "toys"),
    *("placecue_integrators", "numpy", "scipy", "sklearn", "joblib", "numba", "threadpoolctl"),
    *sys.stdlib_module_names,
}
ACTS = (
    *("exec", "pickle.", "subprocess.", "socket.", "shutil.", "ctypes.dlopen"),
    *("os.system", "os.exec", "os.fork", "os.posix_spawn", "os.spawn", "os.mkdir", "os.remove"),
    *("os.rename", "os.rmdir", "os.link", "os.symlink", "os.truncate", "os.chmod", "os.utime"),
)
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_TRUNC
#: Who runs code of installed modules: imports, annotations, records.
MAKERS = (
    "importlib._bootstrap",
    "importlib._bootstrap_external",
    "typing",
    "annotationlib",
    "dataclasses",
    "collections",
)
SECONDS = 20.0


class TooSlow(BaseException):
    """Believing took longer than anybody waits; how long it takes is a parameter's business."""


class Watch:
    """Notes what the process does, while it is asked to, other than reading and computing."""

    def __init__(self) -> None:
        self.acts: Counter[str] = Counter()
        self.on = False
        sys.addaudithook(self._hook)

    @contextmanager
    def watching(self) -> Iterator[None]:
        self.on = True
        try:
            yield
        finally:
            self.on = False

    def _hook(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on:
            return
        if event == "open" and isinstance(arguments[2], int) and arguments[2] & WRITES:
            self.acts[f"open {arguments[0]}"] += 1
        elif event == "import" and arguments[0].split(".")[0] not in {
            *KNOWN,
            *sys.stdlib_module_names,
        }:
            self.acts[f"import {arguments[0]}"] += 1
        elif event.startswith(ACTS) and not _of_an_import(event, arguments):
            self.acts[f"{event} {arguments!r:.200}"] += 1


def _of_an_import(event: str, arguments: tuple[Any, ...]) -> bool:
    """Tell whether installed code is imported, or evaluates the annotations of its own classes."""
    if event == "ctypes.dlopen":
        return "site-packages" in str(arguments[0])
    return event == "exec" and sys._getframe(2).f_globals.get("__name__") in MAKERS


def models(folder: Path) -> list[Path]:
    """Save models of several kinds."""
    known, walk = registry(), Walk(rounds=2, stay=6)
    steps = [
        ["scale", {"estimator": "sklearn.preprocessing.StandardScaler"}],
        ["tree", {"estimator": "sklearn.tree.DecisionTreeClassifier", "params": {"max_depth": 3}}],
    ]
    forest = ScikitLearn(params={"n_estimators": 3})
    chain = ScikitLearn("sklearn.pipeline.Pipeline", {"steps": steps})
    svm = SVM(kernel=RBF(0.1), probability="sigmoid", scaling=StandardScaling())
    pipelines = [
        pipeline(),
        Pipeline({"beams": (Beams(), forest)}),
        Pipeline({"beams": (Beams(), chain)}),
        Pipeline({"beams": (Beams(), svm)}, unknown=Unknown(0.3)),
        Pipeline({"beams": (Beams(), AdaBoost(rounds=4))}),
    ]
    return [
        save_model(each.fit(walk), folder / f"m{i}", known, trained_on=[walk])
        for i, each in enumerate(pipelines)
    ]


def main(count: int, seed: int) -> dict[str, Any]:
    """Tamper with ``count`` folders and say what came of it."""
    chance = random.Random(seed)
    watch, known = Watch(), registry()
    outcomes: Counter[str] = Counter()
    foreign: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as temporary:
        whole = models(Path(temporary) / "whole")
        marker = Path(temporary) / "marker"
        observations = list(Walk(rounds=1, stay=1))
        for each in whole:
            load_model(each, known).believe(observations)
        before = _peak()
        for number in range(count):
            folder = Path(temporary) / f"tampered{number}"
            shutil.copytree(chance.choice(whole), folder)
            how = _tamper(folder, chance, marker)
            _try(folder, known, observations, watch, how, outcomes, foreign)
            shutil.rmtree(folder)
        return {
            "outcomes": outcomes,
            "foreign_at_load": {k: n for k, n in foreign.items() if k.startswith("load")},
            "foreign_at_believe": {k: n for k, n in foreign.items() if k.startswith("believe")},
            "acts": watch.acts,
            "marker": marker.exists(),
            "peak": _peak(),
            "before": before,
        }


def _tamper(folder: Path, chance: random.Random, marker: Path) -> str:
    """Tamper once or twice; half of the time make the digests right again."""
    several = [JSON_TAMPERINGS, JSON_TAMPERINGS, ARRAYS_TAMPERINGS]
    chosen: list[Callable[..., Any]] = [
        chance.choice(chance.choice(several)) for _ in range(chance.choice((1, 1, 2)))
    ]
    chosen.sort(key=lambda each: each is write_very_much)  # which takes memory to tamper with
    if chance.random() < 0.3:  # last: what is no plain file cannot be tampered with
        chosen[-1] = chance.choice(FILE_TAMPERINGS)
    done = []
    for tampering in chosen:
        # The first may have left nothing that the second could tamper with.
        with suppress(Exception):
            tampering(folder, chance, marker)
            done.append(tampering.__name__)
    if chance.random() < 0.7 and reseal(folder):
        done.append("resealed")
    return " + ".join(done)


def _try(
    folder: Path,
    known: Any,
    observations: list[Any],
    watch: Watch,
    how: str,
    outcomes: Counter[str],
    foreign: Counter[str],
) -> None:
    stage = "load"
    try:
        with watch.watching(), _no_longer_than(SECONDS):
            loaded = load_model(folder, known)
            stage = "believe"
            loaded.believe(observations)
        outcomes["believed"] += 1
    except PlacecueError as error:
        outcomes[f"refused at {stage}"] += 1
        if "\n" in str(error) or len(str(error)) > 1500:
            foreign[f"{stage}: {how}: not one line: {str(error)[:300]}"] += 1
    except TooSlow:
        outcomes[f"too slow at {stage}"] += 1
    except Exception as error:
        outcomes[f"foreign at {stage}"] += 1
        foreign[f"{stage}: {how}: {type(error).__name__}: {str(error)[:200]}"] += 1


@contextmanager
def _no_longer_than(seconds: float) -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TooSlow

    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def _peak() -> float:
    """Return the most memory that the process ever had, MB."""
    # What getrusage says begins with what the process had that started this one.
    status = Path("/proc/self/status").read_text()
    return int(re.search(r"VmHWM:\s+(\d+)", status)[1]) / 1024  # type: ignore[index]


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    print(json.dumps(main(int(sys.argv[1]), int(sys.argv[2])), indent=1))
