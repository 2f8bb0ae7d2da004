"""Results that nobody computed: of any number of pairs, methods and samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from placecue import LaserScan, Observation
from placecue.evaluation.results.about import About, Method, Recording
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.results import Results

CLASSES = ("corridor", "kitchen", "one-person office", "printer area", "two-person office")
METHODS = {
    "crfh": Method(("crfh",), "", "cue=crfh integrator=none"),
    "laser": Method(("laser",), "", "cue=laser integrator=none"),
    "crfh + laser": Method(("crfh", "laser"), "svm_das", "cue=[crfh,laser]"),
}
#: Names that want to be something else in a page.
SCRIPT = "<script>document.title='taken'</script>"
QUOTES = "\"quoted\" 'and' <b onmouseover=x>&amp;"
WORLD = "🤖 مطبخ"
SECOND = 1_000_000_000
START = 1_150_000_000 * SECOND


@dataclass
class Made:
    """An experiment of recordings in a ring, each tested on models of others.

    Parameters
    ----------
    pairs : int
        Ordered pairs, in turn of four experiments.
    samples : int
        Of each recording.
    methods : mapping of str to Method
    classes : sequence of str
    """

    pairs: int = 4
    samples: int = 40
    methods: dict[str, Method] = field(default_factory=lambda: dict(METHODS))
    classes: Sequence[str] = CLASSES
    recordings: int = 12

    def name(self, number: int) -> str:
        light, run = divmod(number % self.recordings, 4)
        return f"{('cloudy', 'night', 'sunny')[light % 3]} {run + 1}"

    def about(self) -> About:
        counts = dict.fromkeys(self.classes, self.samples // len(self.classes))
        recordings = {}
        for number in range(self.recordings):
            light, run = self.name(number).split()
            metadata = {"illumination": light, "run": run}
            recordings[self.name(number)] = Recording(
                f"logs/{light}{run}.mcap", f"{number:064x}", metadata, counts
            )
        experiments = {f"Exp {n + 1}": len(range(n, self.pairs, 4)) for n in range(4)}
        return About(
            "Office, 12 sequences",
            recordings,
            self.methods,
            {name: count for name, count in experiments.items() if count},
            versions={"placecue": "0.1.0", "numpy": "2.4.6"},
            command="placecue evaluate experiment=office_idol world.seed=0",
            began="2026-11-28T12:00:00+00:00",
            seconds={"features": 151.25, "training": 620.5, "tests": 48.0},
        )

    def pair(self, number: int) -> Pair:
        step = 1 + number // self.recordings
        train, test = self.name(number), self.name(number + step)
        return Pair(f"Exp {number % 4 + 1}", "", (train,), test)

    def results(self) -> Results:
        return Results(
            self.result(pair, name, number)
            for number, name in enumerate(self.methods)
            for pair in map(self.pair, range(self.pairs))
        )

    def result(self, pair: Pair, method: str, number: int) -> Result:
        random = np.random.default_rng((number, *pair.test.encode(), *str(pair).encode()))
        truth = (np.arange(self.samples) % len(self.classes)).astype(np.int16)
        other = random.integers(0, len(self.classes), self.samples)
        decided = np.where(random.random(self.samples) < 0.18, other, truth).astype(np.int16)
        stamps = START + np.arange(self.samples) * SECOND // 5
        confidence = random.gamma(2.0, 0.4, self.samples).astype(np.float32)
        seconds = {"training": 2.5, "testing": 0.25}
        return Result(
            pair, method, tuple(self.classes), truth, decided, confidence, stamps, {}, seconds
        )

    def open_recording(self, name: str) -> Iterator[Observation]:
        """Yield pictures of stripes and scans of rectangles."""
        random = np.random.default_rng([*name.encode()])
        angles = np.radians(np.linspace(-90, 90, 181))
        for number in range(self.samples):
            length, width = 2.0 + 4 * random.random(), 1.5 + 2 * random.random()
            with np.errstate(divide="ignore"):
                walls = np.abs([length / np.cos(angles), width / np.sin(angles)])
            ranges = walls.min(axis=0) + random.normal(0, 0.02, len(angles))
            yield Observation(
                int(START + number * SECOND // 5),
                image=partial(_picture, number % 17),
                scan=LaserScan(angles, ranges, 0.02, 30.0),
                label=self.classes[number % len(self.classes)],
            )


@cache
def _picture(number: int) -> NDArray[np.uint8]:
    """Return one of a few noisy pictures of stripes."""
    stripes = 127 + 100 * np.sin(np.arange(320) / (2 + number))
    image = np.tile(stripes[None, :, None], (240, 1, 3)) * [1.0, 0.8, 0.6]
    noisy = image + np.random.default_rng(number).normal(0, 12, image.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)
