"""Makes recordings, models and beliefs of the labelling benchmark once, and keeps them."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from labelling_building import plan as drawn_plan
from labelling_plan import Test, models, recordings
from labelling_register import PIXEL, ClassMap, Registration, end_points, registered
from scipy.spatial import KDTree

from placecue import Belief, Observation, SemanticMap
from placecue.components.build import build
from placecue.components.manager import load_plugins
from placecue.evaluation.area_scores import TruthAt
from placecue.labels.relabelled import relabelled
from placecue.pipeline import Pipeline
from placecue.source import guarded
from placecue.starter.pipeline import Starter
from placecue.storage.model import load_model

Room = tuple[int, str, int, str]
Moments = list[tuple[Observation, Belief | None]]

REGISTRY = load_plugins(built_ins_only=True).registry
#: Plan of the building that is drawn for the tuning half.
DRAWN = "drawn_building.geojson"
#: Grey values of the labelled plans.
LEGEND = {77: "room", 115: "hallway", 179: "doorway"}


class Data:
    """What the benchmark works on.

    Parameters
    ----------
    folder : Path
        Where everything is kept; what is there is not made again.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.recorded = Path(os.environ["PLACECUE_DATA"])
        self._moments: dict[str, Moments] = {}

    def _said(self, value: Any) -> Any:
        if isinstance(value, dict):
            return {key: self._said(each) for key, each in value.items()}
        if not isinstance(value, str):
            return value
        folders = {
            "{data}": self.recorded,
            "{recordings}": self.folder / "recordings",
            "{drawn}": self.folder / "recordings" / DRAWN,
        }
        for name, path in folders.items():
            value = value.replace(name, str(path))
        return value

    def _run(self, *words: str) -> None:
        subprocess.run([sys.executable, "-m", "placecue", *words], check=True)

    def make(self) -> None:
        """Record and train what is not there yet."""
        (self.folder / "recordings").mkdir(parents=True, exist_ok=True)
        (self.folder / "recordings" / DRAWN).write_text(json.dumps(drawn_plan()), encoding="utf-8")
        for name, source in recordings().items():
            path = self.folder / "recordings" / f"{name}.mcap"
            if not path.exists():
                given = [
                    f"source.{key}={self._said(value)}"
                    for key, value in source.items()
                    if key != "plugin"
                ]
                self._run("convert", f"source={source['plugin']}", *given, f"out={path}")
        for name in models():
            self.model(name)

    def model(self, name: str) -> Pipeline:
        """Return a model, trained if it is not there yet."""
        if name == "starter":
            return Starter(REGISTRY).pipeline(None, laser=True, image=False)
        path = self.folder / "models" / name.replace(" ", "_")
        if not (path / "manifest.json").exists():
            words = [self._said(word) for word in models()[name]]
            cache = f"cache.folder={self.folder / 'cache'}"
            self._run("train", *words, cache, f"out={path}", "overwrite=true", "report=false")
        return load_model(path, REGISTRY)

    def moments(self, test: Test) -> Moments:
        """Return the observations of a test, without images, and what its model says of each."""
        if test.name not in self._moments:
            self._moments[test.name] = self._read(test)
        return self._moments[test.name]

    def _read(self, test: Test) -> Moments:
        path = self.folder / "moments" / f"{test.name.replace(' ', '_')}.pickle"
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            made = self._believed(test)
            part = path.with_suffix(".part")
            part.write_bytes(pickle.dumps(made))
            part.replace(path)
        found: Moments = pickle.loads(path.read_bytes())
        return found if test.truth is None else self._labelled(found, test)

    def _believed(self, test: Test) -> Moments:
        source = guarded(build(self._said(test.source), "source", REGISTRY))
        log = relabelled(source, test.labels)
        return [(_bare(o), _plain(b)) for o, b in self.model(test.model).follow(log, 16)]

    # ------------------------------------------------------------------ truth

    def plan(self, name: str) -> ClassMap:
        """Return a labelled plan."""
        path = self.recorded / "maps" / f"{name}.png"
        if name.endswith("segmentation"):
            return ClassMap.of_lines(path)
        return ClassMap.of_classes(path, LEGEND)

    def registration(self, test: Test, moments: Moments) -> Registration:
        """Return how the plan of a test lies to its log, found once."""
        path = self.folder / "moments" / f"{test.name.replace(' ', '_')}.registration"
        if not path.exists():
            found = registered(end_points(o for o, _ in moments), self.plan(str(test.truth)))
            path.write_bytes(pickle.dumps(found))
        known: Registration = pickle.loads(path.read_bytes())
        return known

    def truth_at(self, test: Test, moments: Moments) -> TruthAt | None:
        """Return what names the class of a place in a log with a plan; None without one."""
        if test.truth is None:
            return None
        plan, at = self.plan(test.truth), self.registration(test, moments)
        return lambda x, y: plan.label_at(*at.on_map(np.array([[x, y]]))[0])

    def rooms(self, test: Test, moments: Moments, made: SemanticMap) -> list[Room]:
        """Return the rooms of a plan that were visited, and what most of the way in each is called.

        Each is its number, its true class, how many observations, and what the map says.
        """
        if test.truth is None or not made.areas:
            return []
        plan, at = self.plan(test.truth), self.registration(test, moments)
        numbers = plan.rooms()
        ways = [(x, y, area.label) for area in made.areas for x, y in area.trajectory]
        nearest = KDTree([(x, y) for x, y, _ in ways])
        told: dict[tuple[int, str], Counter[str]] = defaultdict(Counter)
        for seen, _ in moments:
            if seen.pose is None or seen.label is None:
                continue
            column, row = (at.on_map(np.array([[seen.pose.x, seen.pose.y]]))[0] // PIXEL).astype(
                int
            )
            said = ways[int(nearest.query([seen.pose.x, seen.pose.y])[1])][2]
            told[int(numbers[row, column]), seen.label][said] += 1
        return [
            (number, label, said.total(), said.most_common(1)[0][0])
            for (number, label), said in sorted(told.items())
        ]

    def _labelled(self, moments: Moments, test: Test) -> Moments:
        plan, at = self.plan(str(test.truth)), self.registration(test, moments)
        found = []
        for seen, belief in moments:
            label = None
            if seen.pose is not None:
                label = plan.label_at(*at.on_map(np.array([[seen.pose.x, seen.pose.y]]))[0])
            found.append((seen.relabelled(label), belief))
        return found


def _bare(seen: Observation) -> Observation:
    return Observation(seen.stamp, scan=seen.scan, pose=seen.pose, label=seen.label)


def _plain(belief: Belief | None) -> Belief | None:
    if belief is None:
        return None
    told = belief.stamp, belief.scores, belief.label, belief.confidence
    worth = {"sharpness": belief.sharpness, "agreement": belief.agreement}
    return Belief(*told, dict(belief.cue_scores), **worth)


if __name__ == "__main__":
    Data(Path(sys.argv[1])).make()
