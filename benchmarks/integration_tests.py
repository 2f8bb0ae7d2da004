"""What the integrators are tried on, and the scores of single-cue models there, kept in a folder.

A test has parts, each with models of its own: an outer fold of the NYU frames, or a sequence of
the simulated office. What integrators are fitted on is held out of the models of that part: by
inner folds of the training frames (NYU), or because it is what the models of the partner sequence
say of their test sequences (office), as in the paper.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import joblib
import numpy as np
from cues_and_classifiers import REGISTRY
from hydra import compose, initialize_config_module
from numpy.typing import NDArray
from nyu_frames import ROOMS, Frames, OuterFold, outer_folds
from office_benchmark import PARTNER
from office_benchmark import Sequence as Drive

from placecue import FoldScheme, InterleavedChunks, Pipeline, Scenes, Scores
from placecue.components.build import plain
from placecue.components.options import register_with_hydra
from placecue.components.pipelines import build_pipeline
from placecue.learning.costs import measured
from placecue.storage.feature_cache import FeatureCache
from placecue_office.simulator import Office

#: The cues, with the words that choose them.
CUES = {
    "crfh": ["cue=crfh"],
    "sift": ["cue=sift"],
    "laser": ["cue=laser"],
    "colour": ["cue=color_histogram"],
    "fisher": ["cue=fisher_vector"],
    "joint_rbf": ["cue=joint"],
}
#: Which observations of the office are taken.
EVERY = 3


@dataclass(frozen=True)
class Said:
    """What a single-cue model says of some samples that it has not seen.

    Parameters
    ----------
    scores : Scores
        Of n samples; NaN where it says nothing.
    labels : ndarray of str, shape (n,)
        Their classes.
    stamps : ndarray of int64, shape (n,)
        Their times, ns.
    groups : ndarray, shape (n,), or None
        What folds keep together.
    scenes : ndarray of str, shape (n,)
        What is drawn together for intervals: scenes, or sequences.
    """

    scores: Scores
    labels: NDArray[Any]
    stamps: NDArray[np.int64]
    groups: NDArray[np.int64] | None
    scenes: NDArray[Any]


class Part(NamedTuple):
    """What one model says, for the integrator and in the end, and what a sample costs, ms."""

    fitting: Said
    testing: Said
    cost: float


class Nyu:
    """Frames of NYU Depth v2 in outer folds of whole scenes."""

    title = "NYU, {} rooms"

    def __init__(self, rooms: str) -> None:
        self.rooms = rooms
        self.folds: FoldScheme = Scenes()
        self.title = f"NYU, {rooms} rooms"

    def parts(self) -> Sequence[str]:
        """Return the names of the outer folds."""
        return [str(number) for number in range(5)]

    def fitted_on(self, part: str) -> tuple[str, bool]:
        """Return the part, and whether its testing samples, that the integrator is fitted on."""
        return part, False

    def fold(self, part: str) -> OuterFold:
        """Return the frames of an outer fold."""
        return _folds(self.rooms)[int(part)]

    def compute(self, part: str, pipeline: Pipeline) -> Part:
        """Train on the training frames of a fold and score those held out."""
        fold = self.fold(part)
        samples = pipeline.collect(fold.training)
        pipeline.fit_cues(samples)
        unseen = pipeline.held_out(samples)
        [cue] = pipeline.cues
        return Part(
            Said(
                unseen.evidence.scores(cue),
                unseen.labels,
                unseen.stamps,
                unseen.groups,
                fold.training.scenes,
            ),
            _said(pipeline, fold.held_out),
            measured(pipeline.cues, fold.training)[cue],
        )


class World:
    """Sequences of a simulated office; integrators are fitted on what the partner's models say."""

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self.folds: FoldScheme = InterleavedChunks()
        self.title = f"office, world {seed}"

    def parts(self) -> Sequence[str]:
        """Return the names of the sequences that models are trained on: two pairs of partners."""
        return [f"{light}{run}" for light in ("cloudy", "night") for run in (1, 2)]

    def fitted_on(self, part: str) -> tuple[str, bool]:
        """Return the part, and whether its testing samples, that the integrator is fitted on."""
        return f"{part[:-1]}{PARTNER[int(part[-1])]}", True

    def compute(self, part: str, pipeline: Pipeline) -> Part:
        """Train on a sequence and score those that the experiments test its models on."""
        drive = Drive(part[:-1], int(part[-1]))
        pipeline.fit_cues(pipeline.collect(self.frames(drive)))
        tests = [_said(pipeline, self.frames(test)) for _, test in drive.tests()]
        said = Said(
            Scores(np.vstack([t.scores.values for t in tests]), tests[0].scores.layout),
            *(np.concatenate([getattr(t, name) for t in tests]) for name in ("labels", "stamps")),
            groups=np.repeat(np.arange(len(tests)), [len(t.labels) for t in tests]),
            scenes=np.concatenate([t.scenes for t in tests]),
        )
        [cue] = pipeline.cues
        return Part(said, said, measured(pipeline.cues, self.frames(drive))[cue])

    def frames(self, drive: Drive) -> Every:
        """Return every third observation of a sequence."""
        return Every(self.seed, drive)


class Every:
    """Every third observation of a sequence of the simulated office."""

    def __init__(self, seed: int, drive: Drive) -> None:
        settings = {"illumination": drive.light, "run": drive.run, "speed": 0.4, "turn_rate": 0.7}
        self.office = Office(seed=seed, **settings)  # type: ignore[arg-type]
        self.name = drive.name

    def __iter__(self) -> Iterator[Any]:
        known = enumerate(self.office)
        return (each.of_log(self.name) for number, each in known if number % EVERY == 0)


TESTS = {
    "nyu_four": Nyu("four"),
    "nyu_eight": Nyu("eight"),
    "office_0": World(0),
    "office_1": World(1),
}


def evidence(folder: Path, test: str, part: str, cue: str) -> Part:
    """Return what a single-cue model says in a part of a test, computed once."""
    path = folder / "scores" / f"{test}_{part}_{cue}.joblib"
    if not path.exists():
        print(f"{test} {part}: {cue}", flush=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        with FeatureCache(folder / "features", REGISTRY) as extraction:
            pipeline = _pipeline(test, cue)
            pipeline.extraction = extraction
            made = TESTS[test].compute(part, pipeline)
        joblib.dump(made, path.with_suffix(".part"))
        path.with_suffix(".part").rename(path)
    return _loaded(path)


@lru_cache(maxsize=64)
def _loaded(path: Path) -> Part:
    return joblib.load(path)  # type: ignore[no-any-return]


def _pipeline(test: str, cue: str) -> Pipeline:
    """Return a pipeline of one cue, as ``placecue train`` would build it."""
    words = [*CUES[cue], "integrator=none", "log=here"]
    if test.startswith("nyu") and cue in ("laser", "joint_rbf"):
        # The group's features are of 180 degrees.
        where = "cues.joint.parts.laser" if cue.startswith("joint") else "cues.laser"
        words.append(f"{where}.preset=full")
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = plain(compose("train", words))
    made = build_pipeline({"cues": config["cues"]}, REGISTRY)
    return Pipeline(made.cues, folds=TESTS[test].folds)


def _said(pipeline: Pipeline, log: Any) -> Said:
    samples = pipeline.collect(log)
    [cue] = pipeline.cues
    scores = pipeline.evidence_of(samples).scores(cue)
    scenes = log.scenes if isinstance(log, Frames) else np.full(len(samples), log.name)
    return Said(scores, samples.labels, samples.stamps, samples.groups, scenes)


@cache
def _folds(rooms: str) -> list[OuterFold]:
    return list(outer_folds(Path(os.environ["PLACECUE_DATA"]), ROOMS[rooms]))
