"""What deep cues and objects are worth on the NYU frames: the tables of docs/deep.md.

    PLACECUE_DATA=FOLDER python benchmarks/deep.py runs/deep

Frames of whole scenes are held out; searches and integrators cut what is left at scenes too.
Features and what each fold decided are kept in the folder, so that a run that was stopped goes on
where it was; take another folder after a change of the code. At the end the tables are written
into the page; what joined cues are worth in the light is ``experiment=nyuv2_deep``.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from deep_page import write
from deep_plan import CUES, DARKER, FEW, FOLDS, METHODS, NETWORKS, PLACES, TIMED
from hydra import compose, initialize_config_module
from nyu_frames import ROOMS, Frames, OuterFold, frames, outer_folds

from placecue import Extraction, Observation, Pipeline, Schemes, StoredEvidence
from placecue.components.build import plain
from placecue.components.manager import load_plugins
from placecue.components.options import register_with_hydra
from placecue.components.pipelines import build_pipeline
from placecue.storage.feature_cache import FeatureCache
from placecue_classifiers.knowledge import Knowledge
from placecue_classifiers.nearest_mean import NearestMean

Decided = dict[str, list[str]]
REGISTRY = load_plugins().registry


def pipeline_of(words: Sequence[str]) -> Pipeline:
    """Return the pipeline that ``placecue train`` would take."""
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = plain(compose("train", [*words, "folds=scenes", "log=here"]))
    return build_pipeline(config, REGISTRY)


def kept(path: Path, make: Callable[[], Any]) -> Any:
    """Return what a file holds, or make it and write the file."""
    if not path.exists():
        print(path.stem, flush=True)
        made = make()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(made))
    return json.loads(path.read_text())


# ---------------------------------------------------------------------- trained


def trained(fold: OuterFold, cues: Sequence[str], cache: FeatureCache) -> Decided:
    """Return truth, scenes and decisions of every method for one fold, and in the dark."""
    words = [word for cue in cues for word in CUES[cue]]
    pipeline = pipeline_of([f"cue=[{','.join(cues)}]", *words])
    pipeline.extraction = cache
    samples = pipeline.collect(fold.training)
    pipeline.fit_cues(samples)
    held_out = pipeline.held_out(samples)
    levels = {"": fold.held_out}
    levels |= {f" / {by}": darkened(fold.held_out, by) for by in DARKER}
    evidence = {}
    for level, seen in levels.items():
        evidence[level] = pipeline.evidence_of(pipeline.collect(seen))
    made = {"truth": fold.held_out.labels.tolist(), "scenes": fold.held_out.scenes.tolist()}
    for name, (of, how) in METHODS.items():
        if not set(of) <= set(cues):
            continue
        schemes = None
        if how:
            integrator = pipeline_of([f"integrator={how}"]).integrator
            schemes = Schemes.fit(integrator, held_out.having(of))
        for level, there in evidence.items():
            some = StoredEvidence({cue: there.scores(cue) for cue in of})
            scores = some.scores(of[0]) if schemes is None else schemes.integrate(some)[0]
            made[f"{name}{level}"] = scores.decide().labels.tolist()
    return made


def darkened(seen: Frames, by: int) -> Frames:
    """Return frames with a part of their light."""
    return Frames([_darkened(each, by) for each in seen.observations])


def _darkened(observation: Observation, by: int) -> Observation:
    image = np.asarray(observation.image)
    return observation.altered(f"darkened by {by}", image=(image // by).astype(np.uint8))


def network(data: Path, name: str, cache: FeatureCache) -> dict[str, Any]:
    """Return decisions by one of the networks alone, and what a frame takes, ms."""
    made: dict[str, Any] = {}
    for rooms, places in ROOMS.items():
        truth, scenes, decided = [], [], []
        for fold in outer_folds(data, places, FOLDS):
            pipeline = pipeline_of(["cue=lite0", f"cues.lite0.network={name}", "integrator=none"])
            pipeline.extraction = cache
            pipeline.fit(fold.training)
            decided += [belief.label for belief in pipeline.beliefs(fold.held_out, 32)]
            truth += fold.held_out.labels.tolist()
            scenes += fold.held_out.scenes.tolist()
        made[rooms] = {"truth": truth, "scenes": scenes, "decided": decided}
    pipeline.extraction = Extraction()
    made["ms"] = _milliseconds(pipeline, fold.training.observations[:TIMED])
    return made


def _milliseconds(pipeline: Pipeline, observations: Sequence[Observation]) -> float:
    """Return the median of what one frame takes, from its JPEG to its belief."""
    taken = []
    for observation in observations:
        fresh = observation.relabelled(observation.label)  # whose image is not decoded yet
        began = perf_counter()
        list(pipeline.beliefs([fresh]))
        taken.append(perf_counter() - began)
    return 1000 * float(np.median(taken))


# ---------------------------------------------------------------------- with few labels, or none


def features_of(seen: Frames, word: str, cache: FeatureCache) -> Any:
    """Return the features of frames by a cue."""
    cue = next(iter(pipeline_of([f"cue={word}", "integrator=none"]).cues.values())).cue
    return np.asarray(cache.gather(cue, seen).features)


def untrained(data: Path, cache: FeatureCache) -> dict[str, Decided]:
    """Return what the table says of the objects in every frame, for several lists of places."""
    made = {}
    for name, places in PLACES.items():
        seen = frames(data, places)
        scores = (
            Knowledge(places=list(places)).untrained().scores(features_of(seen, "objects", cache))
        )
        made[name] = {
            "truth": seen.labels.tolist(),
            "scenes": seen.scenes.tolist(),
            "decided": scores.decide().labels.tolist(),
        }
    return made


def few_labels(data: Path, cache: FeatureCache) -> dict[str, dict[str, float]]:
    """Return balanced accuracies with so many labels a class: mean and deviation over draws."""
    folds = list(outer_folds(data, ROOMS["eight"], FOLDS))
    features = [
        (features_of(fold.training, "lite0", cache), features_of(fold.held_out, "lite0", cache))
        for fold in folds
    ]
    made = {}
    for covariance in ("none", "shared"):
        for count in FEW:
            if covariance == "shared" and count == 1:
                continue  # nothing varies within a class
            draws = 20 if count and covariance == "none" else 3 if count else 1
            found = [
                _accuracy(list(_drawn(folds, features, count, covariance, seed)))
                for seed in range(draws)
            ]
            made[f"{covariance} {count or 'all'}"] = {
                "mean": float(np.mean(found)),
                "deviation": float(np.std(found)),
                "draws": draws,
            }
    return made


def _drawn(
    folds: Sequence[OuterFold], features: Sequence[Any], count: int, covariance: str, seed: int
) -> Iterator[tuple[Any, Any]]:
    """Yield truth and decisions of each fold, trained on a draw of its training frames."""
    generator = np.random.default_rng(seed)
    for fold, (training, held_out) in zip(folds, features, strict=True):
        labels = fold.training.labels
        rows = np.arange(len(labels))
        if count:
            of_classes = (np.flatnonzero(labels == name) for name in np.unique(labels))
            rows = np.concatenate(
                [
                    generator.choice(each, min(count, len(each)), replace=False)
                    for each in of_classes
                ]
            )
        classifier = NearestMean(covariance).fit(training[rows], labels[rows])
        yield fold.held_out.labels, classifier.predict(held_out)


def _accuracy(decided: list[tuple[Any, Any]]) -> float:
    truth, said = (np.concatenate(each) for each in zip(*decided, strict=True))
    return float(100 * np.mean([(said[truth == name] == name).mean() for name in np.unique(truth)]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cues", nargs="+", choices=tuple(CUES), default=list(CUES))
    arguments = parser.parse_args()
    data, folder = Path(os.environ["PLACECUE_DATA"]), arguments.folder
    with FeatureCache(folder / "features", REGISTRY) as cache:
        kept(folder / "untrained.json", lambda: untrained(data, cache))
        for name in NETWORKS:
            kept(folder / "networks" / f"{name}.json", partial(network, data, name, cache))
        kept(folder / "few_labels.json", lambda: few_labels(data, cache))
        for number, fold in enumerate(outer_folds(data, ROOMS["four"], FOLDS)):
            name = f"four_{'+'.join(arguments.cues)}_{number}.json"
            kept(folder / "folds" / name, partial(trained, fold, arguments.cues, cache))
    write(folder)


if __name__ == "__main__":
    main()
