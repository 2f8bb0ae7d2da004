"""Memory of labelling over an eight-hour drive: new ground, standing, turning, known ground.

    python benchmarks/labelling_memory.py FOLDER

A robot drives through an endless office floor (corridors with rooms on both sides, laser scans
ray-cast, beliefs right in nine of ten cases), one observation a second at 0.5 m/s, through the
shipped accumulator and the listeners of ``placecue label`` that hold anything. The memory of the
process is written into FOLDER/memory.csv every five minutes of the drive, as it comes; where the
file is whole it is only drawn. docs/labelling_memory.png and the table of docs/live.md come of it.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
import psutil
from labelling_outcomes import accumulator
from matplotlib.figure import Figure
from tables import put, table

from placecue import Belief, LaserScan, Observation, OneAgainstAll, Pose2D, Scores
from placecue.evaluation.surroundings import Surroundings
from placecue.evaluation.tally import Tally
from placecue.free_space import FreeSpace
from placecue_office.trace import cast

DOCS = Path(__file__).parents[1] / "docs"
RATE, SPEED = 1.0, 0.5
#: What the robot does, and for how many hours.
DRIVE = [
    ("new", 2),
    ("stands", 1),
    ("known", 1),
    ("new", 1),
    ("turns", 1),
    ("new", 1),
    ("known", 1),
]
#: A row of rooms: length of a lane, distance between lanes, half a corridor, depth and width of a
#: room, half a door, m.
LANE, APART, HALF, DEPTH, ROOM, DOOR = 60.0, 12.0, 1.0, 4.0, 5.0, 0.45
ANGLES = np.radians(np.arange(-90, 91, 1.0))
CLASSES = ("corridor", "kitchen", "office")
LAYOUT = OneAgainstAll(CLASSES)


def walls(lane: int) -> np.ndarray:
    """Return the walls of a lane, shape (k, 4): from and to, m."""
    y, found = lane * APART, []
    for side in (-1, 1):
        near, far = y + side * HALF, y + side * (HALF + DEPTH)
        for x in np.arange(0, LANE, ROOM):
            found += [
                (x, near, x + ROOM / 2 - DOOR, near),
                (x + ROOM / 2 + DOOR, near, x + ROOM, near),
                (x, near, x, far),
                (x, far, x + ROOM, far),
            ]
        found.append((LANE, near, LANE, far))
    return np.array(found)


def corners() -> Iterator[tuple[float, float]]:
    """Yield where the robot turns: along each lane, two metres into every third room."""
    lane = 0
    while True:
        y = lane * APART
        for number, x in enumerate(np.arange(ROOM / 2, LANE, ROOM)):
            yield float(x), y
            if number % 3 == 0:
                yield float(x), y + HALF + DEPTH / 2
                yield float(x), y
        lane += 1
        yield LANE + 1.0, y  # around the end of the wall, and back along the outside
        yield LANE + 1.0, y + APART / 2
        yield -1.0, y + APART / 2
        yield -1.0, lane * APART


def new_ground() -> Iterator[Pose2D]:
    """Yield poses of a robot that is never where it was before, one an observation."""
    for (x1, y1), (x2, y2) in pairwise(corners()):
        length = float(np.hypot(x2 - x1, y2 - y1))
        heading = float(np.arctan2(y2 - y1, x2 - x1))
        for t in np.arange(0, length, SPEED / RATE) / length:
            yield Pose2D(x1 + t * (x2 - x1), y1 + t * (y2 - y1), heading)


def drive() -> Iterator[tuple[str, Pose2D]]:
    """Yield what the robot does, and where it is."""
    ahead, way = new_ground(), []
    for what, hours in DRIVE:
        count = round(hours * 3600 * RATE)
        if what == "new":
            part = list(islice(ahead, count))
            way += part
        elif what == "known":
            part = [*way[-count // 2 :][::-1], *way[-count // 2 :]][:count]
        else:
            turn = 0.3 if what == "turns" else 0.0
            last = way[-1]
            part = [Pose2D(last.x, last.y, last.theta + turn * i) for i in range(count)]
        yield from ((what, pose) for pose in part)


def seen(number: int, pose: Pose2D, lanes: dict[int, np.ndarray]) -> Observation:
    """Return what the laser sees at a pose."""
    lane = round(pose.y / APART)
    near = np.concatenate([lanes.setdefault(n, walls(n)) for n in (lane - 1, lane, lane + 1)])
    x = (near[:, 0] + near[:, 2]) / 2
    ranges = np.minimum(
        cast(near[np.abs(x - pose.x) < 15], pose.x, pose.y, ANGLES + pose.theta), 8.0
    )
    return Observation(
        round(number / RATE * 1e9), pose=pose, scan=LaserScan(ANGLES, ranges, 0.02, 7.9)
    )


def believed(number: int, pose: Pose2D, rng: np.random.Generator) -> Belief:
    """Return what is believed at a pose: nine times in ten what is there."""
    aside = abs(pose.y - APART * round(pose.y / APART))
    room = CLASSES[1 + int(pose.x // ROOM) % 2]
    label = "corridor" if aside < HALF or aside > HALF + DEPTH else room
    label = label if rng.random() < 0.9 else CLASSES[rng.integers(3)]
    values = np.where(np.array(CLASSES) == label, 0.5, -0.5)[None]
    return Belief(number, Scores(values, LAYOUT), label, 1.0, {})


def measure(path: Path) -> None:
    """Drive, and write what is held as it comes."""
    process, rng = psutil.Process(), np.random.default_rng(0)
    by, lanes = accumulator([]), {}
    listeners = [Tally(), Surroundings(), FreeSpace()]
    every = round(300 * RATE)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["hours", "doing", "observations of new ground", "MB", "nodes"])
        fresh = 0
        for number, (what, pose) in enumerate(drive()):
            if number % every == 0:
                held = process.memory_info().rss / 1e6
                nodes = len(by.semantic_map().nodes)
                row = [f"{number / RATE / 3600:.3f}", what, fresh, f"{held:.2f}", nodes]
                writer.writerow(row)
                file.flush()
            fresh += what == "new"
            moment, belief = seen(number, pose, lanes), believed(number, pose, rng)
            update = by.update(moment, belief)
            for each in listeners:
                each.observe(moment, belief, update)
            for lane in [n for n in lanes if abs(n - pose.y / APART) > 3]:
                del lanes[lane]


def draw(rows: list[dict[str, str]], path: Path) -> None:
    """Draw memory over time, with what the robot did below."""
    figure = Figure(figsize=(9, 3.5), dpi=100, layout="constrained")
    axes = figure.add_subplot()
    colours = {"new": "#0072B2", "stands": "#E69F00", "turns": "#D55E00", "known": "#009E73"}
    for what, colour in colours.items():
        at = [(float(r["hours"]), float(r["MB"])) for r in rows if r["doing"] == what]
        if at:
            axes.plot(*zip(*at, strict=True), "o", color=colour, markersize=4, label=what)
    axes.set_xlabel("time (h)")
    axes.set_ylabel("memory of the process (MB)")
    axes.set_ylim(0, 1.2 * max(float(r["MB"]) for r in rows))
    axes.legend(ncols=4, loc="lower right")
    figure.savefig(path)


def summary(rows: list[dict[str, str]]) -> str:
    """Return the table: what each stretch added."""
    lines, start = [], 0
    for end in range(1, len(rows) + 1):
        if end < len(rows) and rows[end]["doing"] == rows[start]["doing"]:
            continue
        first, last = rows[start], rows[min(end, len(rows) - 1)]
        more = float(last["MB"]) - float(first["MB"])
        new = int(last["observations of new ground"]) - int(first["observations of new ground"])
        each = f"{1000 * more / new:.2f}" if new else ""
        hours = f"{float(first['hours']):.1f} to {float(last['hours']):.1f}"
        lines.append([hours, first["doing"], f"{more:.1f}", each, last["nodes"]])
        start = end
    return table(
        ["hours", "the robot", "MB more", "kB an observation of new ground", "nodes"], lines
    )


def main(folder: Path) -> None:
    """Measure what is not there yet, and write the page's part."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "memory.csv"
    whole = round(sum(hours for _, hours in DRIVE) * 12)
    if not path.exists() or sum(1 for _ in path.open()) < whole:
        measure(path)
    rows = list(csv.DictReader(path.open()))[1:]  # before the first what is used was not loaded
    draw(rows, DOCS / "labelling_memory.png")
    put(DOCS / "live.md", {"memory": summary(rows)})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
