"""What labelling is tuned on, and what is reported: recordings, models, and tests of two halves.

Nothing of one half is in the other: neither a world, nor a drive, nor a building.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

#: Worlds that nothing else was ever tuned on, and the light of each one's second recording.
TUNED = {100: "cloudy", 101: "night", 102: "sunny", 103: "cloudy", 104: "night"}
#: Plans to drive through; each is labelled by a model of the others.
DRIVEN = ("Fr52", "lab_d_furniture", "lab_ipa", "office_e")
#: A building drawn for this half alone (``labelling_building.py``), in three lights, labelled by a
#: model of these recordings.
DRAWN = {1: "cloudy", 2: "night", 3: "sunny"}
KNOWN = {100: (1, "cloudy"), 101: (2, "night"), 102: (2, "sunny")}
#: The other building's floors, in three lights, and the drives in an unseen one.
FLOORS = {0: "cloudy", 1: "night", 2: "sunny"}
UNSEEN = {1: "cloudy", 2: "night", 3: "sunny"}
PLANS = ("Fr101", *DRIVEN[:1], "intel", *DRIVEN[1:])
CATEGORIES = {
    "one_person_office": "office",
    "two_person_office": "office",
    "office": "office",
    "corridor": "corridor",
    "kitchen": "kitchen",
}
#: As fast as the paper's robot, with a gyroscope; what the demo does.
ROBOT = {"plugin": "office", "drift": 0.003, "speed": 0.5, "rate": 2.5}
#: A scan as CARMEN logs have them, and what makes bare plans look like rooms.
SCANS = {"plugin": "floorplan", "max_range": 20.0, "noise": 0.03}
CLUTTER = {"room": 0.5, "hallway": 0.05}
#: Twice as full, and as noisy, as what models were trained on.
STRANGE = {"clutter": {"room": 1.0, "hallway": 0.1}, "noise": 0.06}

Config = dict[str, Any]


@dataclass(frozen=True)
class Test:
    """A log that is labelled.

    Parameters
    ----------
    name : str
    half : {"tuning", "reporting"}
    model : str
        Which of the models; ``starter`` is shipped.
    source : mapping
        The config of its source; ``{data}`` and ``{recordings}`` stand for folders, ``{drawn}`` for
        the plan of the building that was drawn.
    labels : mapping
        ``label_map`` and ``unmapped_labels`` of its labels.
    truth : str or None
        The picture that tells what is where, registered to the log.
    """

    name: str
    half: str
    model: str
    source: Config
    labels: Config = field(default_factory=dict)
    truth: str | None = None


def recordings() -> dict[str, Config]:
    """Return the sources of what is recorded in the simulator once, by name."""
    drives = [("idol2_floor", seed, 1, "cloudy") for seed in TUNED]
    drives += [("idol2_floor", seed, 2, light) for seed, light in TUNED.items()]
    drives += [("idol2_floor", seed, 1, light) for seed, light in FLOORS.items()]
    drives += [("idol2_floor", 0, 2, "cloudy")]
    drives += [("second_floor", 0, run, light) for run, light in UNSEEN.items()]
    drives += [("{drawn}", 0, run, light) for run, light in DRAWN.items()]
    return {
        recording(world, seed, run, light): {
            **ROBOT,
            "world": world,
            "seed": seed,
            "run": run,
            "illumination": light,
        }
        for world, seed, run, light in drives
    }


def recording(world: str, seed: int, run: int, light: str) -> str:
    """Return the name of a recording."""
    return f"{world.strip('{}')}_{seed}_{light}{run}"


def models() -> dict[str, list[str]]:
    """Return what comes after ``placecue train`` for each model."""
    found = {
        f"floor{seed}": [f"log={{recordings}}/{recording('idol2_floor', seed, 1, 'cloudy')}.mcap"]
        for seed in [*TUNED, 0]
    }
    found["floors"] = _categories([(seed, 1, light) for seed, light in FLOORS.items()])
    found["floors of the tuning half"] = _categories([(s, *how) for s, how in KNOWN.items()])
    found |= {f"plans without {name}": _plans(set(DRIVEN) - {name}) for name in DRIVEN}
    found |= {f"plans without {name}": _plans(set(PLANS) - {name}) for name in ("Fr101", "intel")}
    found["plans"] = _plans(PLANS)
    return found


def _categories(drives: Sequence[tuple[int, int, str]]) -> list[str]:
    """Return the words of a model of three categories, by seed, run and light of its drives."""
    names = [recording("idol2_floor", *drive) for drive in drives]
    logs = ",".join(f"{{recordings}}/{name}.mcap" for name in names)
    named = ",".join(f"{old}: {new}" for old, new in CATEGORIES.items())
    return [
        f"log=[{logs}]",
        "folds=by_log",
        "cues.laser.preset=full",
        f"label_map={{{named}}}",
        "unmapped_labels=drop",
    ]


def _plans(names: Any) -> list[str]:
    paths = ",".join(f"{{data}}/maps/{name}.png" for name in sorted(names))
    return ["+recipe=floorplans", f"source.path=[{paths}]", "label_map={doorway: null}"]


def tests() -> list[Test]:
    """Return the tests of both halves."""
    return [*_floors(), *_drives(), *_unseen(), *_recorded()]


def _floors() -> list[Test]:
    found, seeds = [], list(TUNED)
    for i, (seed, light) in enumerate(TUNED.items()):
        source = _recorded_as("idol2_floor", seed, 2, light)
        other = seeds[(i + 1) % len(seeds)]
        found += [
            Test(f"floor {seed}", "tuning", f"floor{seed}", source),
            Test(f"floor {seed} by {other}", "tuning", f"floor{other}", source),
        ]
    demo = _recorded_as("idol2_floor", 0, 2, "cloudy")
    return [*found, Test("demo", "reporting", "floor0", demo)]


def _drives() -> list[Test]:
    two: Mapping[str, Any] = {"label_map": {"doorway": None}, "unmapped_labels": "keep"}
    found = []
    for name in DRIVEN:
        drive = {
            **SCANS,
            "path": f"{{data}}/maps/{name}.png",
            "mode": "drive",
            "seed": 1,
            "clutter": CLUTTER,
            "beams": 181,
        }
        kinds: Mapping[str, Config] = {
            "dense": {"rate": 5.0, "samples": 1000},
            "sparse": {"rate": 1.0, "samples": 400},
            "strange": {"rate": 2.0, "samples": 600, "seed": 2, **STRANGE},
        }
        for kind, how in kinds.items():
            model = f"plans without {name}"
            found.append(Test(f"{name}, {kind}", "tuning", model, {**drive, **how}, dict(two)))
    return found


def _unseen() -> list[Test]:
    labels = {"label_map": CATEGORIES, "unmapped_labels": "drop"}
    buildings = {
        "drawn building": ("tuning", "floors of the tuning half", "drawn", DRAWN),
        "second_floor": ("reporting", "floors", "second_floor", UNSEEN),
    }
    return [
        Test(f"{name}, {light}", half, model, _recorded_as(world, 0, run, light), labels)
        for name, (half, model, world, lights) in buildings.items()
        for run, light in lights.items()
    ]


def _recorded() -> list[Test]:
    logs = {
        "Freiburg 101": ("freiburg-101-corrected", "plans without Fr101", "Fr101"),
        "Intel": ("intel-corrected", "plans without intel", "intel"),
        "Freiburg 079": ("freiburg-079-corrected", "plans", "Freiburg79_scan_gt_segmentation"),
    }
    carmen = [
        Test(
            name,
            "reporting",
            model,
            {"plugin": "carmen", "path": f"{{data}}/carmen/{log}.log.gz", "max_range": 20.0},
            truth=plan,
        )
        for name, (log, model, plan) in logs.items()
    ]
    bags = {
        "expt04": "expt04.bag",
        "feb13_col": "feb13_col.bag",
        "comprobo22": "comprobo22/macfirst_floor_take_2",
    }
    return carmen + [
        Test(f"bag {name}", "reporting", "starter", _bag(path)) for name, path in bags.items()
    ]


def _bag(path: str) -> Config:
    return {"plugin": "rosbag", "path": f"{{data}}/bags/{path}"}


def _recorded_as(world: str, seed: int, run: int, light: str) -> Config:
    path = f"{{recordings}}/{recording(world, seed, run, light)}.mcap"
    return {"plugin": "mcap", "path": path}
