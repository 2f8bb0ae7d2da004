"""The twelve recordings of a world: scans along the drives of IDOL2, and features, kept on disk."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from laser_worlds_floor import Floor, World

from placecue import Cue, Observation, Pose2D
from placecue.training_set import TrainingSet
from placecue_office.recorded import Drive, all_positions, read_drives
from placecue_sources.scanner import Scanner

LIGHTS = ("cloudy", "night", "sunny")
RUNS = (1, 2, 3, 4)
PARTNER = {1: 2, 2: 1, 3: 4, 4: 3}  # close in time
LATER = {1: 3, 2: 4, 3: 1, 4: 2}  # half a year apart
#: IDOL2's scanner: degrees, beams, m; and its noise, m.
SCANNER = Scanner(180.0, 361, 32.0, 0.01)


class Recording(NamedTuple):
    """One of the twelve: an illumination, which changes nothing for a laser, and a run."""

    light: str
    run: int

    @property
    def name(self) -> str:
        """As IDOL2 calls it."""
        return f"dum_{self.light}{self.run}"

    def tests(self) -> list[tuple[int, Recording]]:
        """Return the experiments and the recordings that what this one taught is tested on."""
        later = LATER[self.run]
        others = [light for light in LIGHTS if light != self.light]
        return [
            (1, Recording(self.light, PARTNER[self.run])),
            *((2, Recording(light, self.run)) for light in others),
            (3, Recording(self.light, later)),
            *((4, Recording(light, later)) for light in others),
        ]


RECORDINGS = [Recording(light, run) for light in LIGHTS for run in RUNS]


class Data:
    """What is recorded in IDOL2, and what a laser would have seen of other worlds.

    Parameters
    ----------
    idol2 : Path
        The folder of the recorded poses and the floor plan.
    folder : Path
        Where features are kept.
    """

    def __init__(self, idol2: Path, folder: Path) -> None:
        self.idol2 = idol2
        self.folder = folder

    def samples(self, seed: int, preset: str, cue: Cue) -> Mapping[str, TrainingSet]:
        """Return the labelled features of the twelve recordings of a world, by name."""
        path = self.folder / f"world{seed}_{preset}.npz"
        if not path.is_file():
            self._extract(seed, cue, path)
        with np.load(path) as kept:
            return {each.name: self._set(each, kept[each.name], cue) for each in RECORDINGS}

    @cached_property
    def drives(self) -> Mapping[str, Drive]:
        """The recorded poses and labels."""
        return read_drives(self.idol2 / "poses.csv.gz")

    @cached_property
    def floor(self) -> Floor:
        """The floor as it is drawn."""
        return Floor.read(self.idol2, all_positions(self.idol2 / "poses.csv.gz"))

    def scans(self, world: World, recording: Recording) -> list[Observation]:
        """Return what a laser measures along a recorded drive."""
        light = LIGHTS.index(recording.light)
        grid, drive = world.recorded(light, recording.run), self.drives[recording.name]
        rng = np.random.default_rng([world.seed, 3, light, recording.run])
        poses = [Pose2D(*pose, "map") for pose in drive.poses.tolist()]
        return [Observation(0, scan=SCANNER.scan(grid, pose, rng), pose=pose) for pose in poses]

    def _extract(self, seed: int, cue: Cue, path: Path) -> None:
        world = World(self.floor, seed)
        made = {each.name: cue.transform(self.scans(world, each)) for each in RECORDINGS}
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(".part.npz")
        np.savez(unfinished, **made)
        unfinished.replace(path)

    def _set(self, recording: Recording, features: np.ndarray, cue: Cue) -> TrainingSet:
        drive = self.drives[recording.name]
        stamps = np.round(drive.stamps * 1e9).astype(np.int64)
        return TrainingSet(features, np.array(drive.labels), stamps, families=cue.families)
