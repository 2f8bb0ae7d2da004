"""Poses corrected by scans against known ones, walls before and after, speed and memory.

    python benchmarks/slam.py FOLDER [PART ...] [--seeds 0:10]

Parts: office (ten drives of two simulated floors at three drifts), carried (a robot that is carried
to where it has been, on both floors), carmen (Freiburg 079, 101 and
Intel, found in PLACECUE_DATA), bags (three robots' logs, found there too), explore (areas labelled
while a robot explores), speed (an hour's drive).
The result of each run is kept as FOLDER/results/NAME.json as it comes, with its trajectories (TUM)
and pictures beside it, and what is there is not run again. What is printed are the tables of
docs/slam.md; errors are evo's absolute pose errors after its alignment by rotation and shift.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import slam_page
from slam_drives import Drive, carmen_drive, carried_drive, drives, office_drive
from slam_drives import bag_drive as bag
from slam_explore import explored, trained
from slam_speed import hour

from placecue.sharpness import Sharpness
from placecue.slam.loops import LoopFinder

FLOORS, DRIFTS = ("idol2_floor", "second_floor"), (0.01, 0.03, 0.05)
CARMEN = ("freiburg-079", "freiburg-101", "intel")
BAGS = ("expt04.bag", "feb13_col.bag", "comprobo22/macfirst_floor_take_2")
#: What wheels err by where the robot is carried, and how far off it may be to know where it is, m.
CARRIED_DRIFT, KNOWS = 0.03, 0.5
#: These robots drive no farther than 16 m: what they saw so much way before, m, is seen again.
SHORT = 3.0

Result = dict[str, Any]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("folder", type=Path)
    options.add_argument("parts", nargs="*", default=list(RUNS))
    options.add_argument("--seeds", default="0:10")
    given = options.parse_args()
    seeds = range(*map(int, given.seeds.split(":")))
    for part in given.parts:
        for name, run in RUNS[part](seeds):
            path = given.folder / "results" / f"{name}.json"
            if not path.exists():
                path.parent.mkdir(parents=True, exist_ok=True)
                found = run(given.folder / "pictures" / name)
                path.write_text(json.dumps({"part": part, "name": name, **found}, indent=1))
                print(f"{name}: {found}", flush=True)
    print(slam_page.tables(given.folder / "results"))


def office(seeds: range) -> Iterator[tuple[str, Callable[[Path], Result]]]:
    """Yield the drives of both floors, the same ones at each drift, the worst first."""
    for drift in reversed(DRIFTS):
        for seed in seeds:
            for floor in FLOORS:
                yield (
                    f"office-{floor}-{100 * drift:.0f}-{seed}",
                    lambda out, f=floor, s=seed, d=drift: {
                        **_errors(office_drive(f, s, d), out if s == 0 else None),
                        "floor": f,
                        "drift": d,
                        "seed": s,
                    },
                )


def carried(seeds: range) -> Iterator[tuple[str, Callable[[Path], Result]]]:
    """Yield drives of a robot that is carried, with loops by likeness and by position alone."""
    for seed in seeds:
        for floor in FLOORS:
            yield f"carried-{floor}-{seed}", lambda out, f=floor, s=seed: _carried(f, s)


def carmen(seeds: range) -> Iterator[tuple[str, Callable[[Path], Result]]]:
    """Yield the recorded logs whose poses were corrected by others."""
    for name in CARMEN:
        yield f"carmen-{name}", lambda out, n=name: _errors(carmen_drive(n), out)


def bags(seeds: range) -> Iterator[tuple[str, Callable[[Path], Result]]]:
    """Yield robots' logs without known poses."""
    for name in BAGS:
        yield f"bag-{Path(name).stem}", lambda out, n=name: _sharpness(bag(n), out)


def speed(seeds: range) -> Iterator[tuple[str, Callable[[Path], Result]]]:
    """Yield an hour's drive."""
    yield "speed-hour", lambda out: hour()


def explore(seeds: range) -> Iterator[tuple[str, Callable[[Path], Result]]]:
    """Yield explorations that are labelled while they go on."""
    model = cache(trained)
    for seed in seeds:
        yield f"explore-{seed}", lambda out, s=seed: explored(model(), s)


RUNS = {
    "office": office,
    "carried": carried,
    "carmen": carmen,
    "bags": bags,
    "explore": explore,
    "speed": speed,
}


def _errors(drive: Drive, out: Path | None) -> Result:
    found = drives(drive)
    reference = drive.true
    assert reference is not None
    if out is not None:
        slam_page.draw(drive, found, out)
    return {
        "scans": len(drive.observations),
        "way": round(drive.way, 1),
        "odometry": slam_page.ape(drive.stamps, drive.raw, reference),
        "told": slam_page.ape(drive.stamps, found.told, reference),
        "slam": slam_page.ape(drive.stamps, found.final, reference),
        "doors_apart": slam_page.doors_apart(drive, found.final),
        "seconds": round(found.seconds, 2),
        "account": asdict(found.account),
    }


def _carried(floor: str, seed: int) -> Result:
    drive, half = carried_drive(floor, seed, CARRIED_DRIFT)
    result: Result = {"floor": floor, "seed": seed, "scans": len(drive.observations)}
    recognised = LoopFinder._recognised
    for name in ("likeness", "position"):
        if name == "position":
            LoopFinder._recognised = lambda *given: None
        try:
            found = drives(drive)
        finally:
            LoopFinder._recognised = recognised
        told = slam_page.off_where_first_fits(found.told, drive.true, half)[half:]
        final = slam_page.off_where_first_fits(found.final, drive.true, half)[half:]
        wrong = np.flatnonzero(told > KNOWS)
        result[name] = {
            # After how many scans it knew for good where it was, and how well, m.
            "knew": int(wrong[-1] + 1) if len(wrong) else 0,
            "of": len(told),
            "off": round(float(np.median(final)), 3),
            "account": asdict(found.account),
        }
    return result


def _sharpness(drive: Drive, out: Path) -> Result:
    found = drives(drive)
    slam_page.draw(drive, found, out)
    shares = {}
    for name, poses in (("odometry", drive.raw), ("slam", found.final)):
        measured = Sharpness(before=SHORT)
        for observation in drive.at(poses):
            measured.observe(observation)
        seen = measured.seen
        cells = slam_page.cells_hit(drive, poses)
        shares[name] = {
            "share": seen.same / max(seen.again, 1),
            "again": seen.again,
            "cells": cells,
        }
    about = {"scans": len(drive.observations), "way": round(drive.way, 1)}
    return {**about, **shares, "account": asdict(found.account)}


if __name__ == "__main__":
    main()
