"""Laser scans ray-cast in labelled floor plans, in one building or several."""

from __future__ import annotations

import logging
import zlib
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from placecue.checks import check_choice, check_number, check_whole
from placecue.errors import UsageError
from placecue.observation import Observation, Pose2D
from placecue.source import Source
from placecue_sources.clutter import cluttered
from placecue_sources.contents import digest_of, existing
from placecue_sources.drive import Drive
from placecue_sources.plan import Plan
from placecue_sources.plan_geojson import read_floor
from placecue_sources.plan_picture import read_picture
from placecue_sources.random_poses import RandomPoses
from placecue_sources.scanner import Scanner

log = logging.getLogger(__name__)

LEGEND: Mapping[int, str] = {77: "room", 115: "hallway", 179: "doorway"}
MODES = ("random", "drive")
BALANCES = ("area", "class")


class FloorPlan(Source):
    """A robot with a laser scanner in one or several labelled floor plans.

    Each sample depends on the seed, the plan's name and the sample's number alone (in a drive
    the pose on the samples before it), so iterating again gives the same. Poses are in frame
    ``map``; with several plans each has its own coordinates, in a frame of the plan's name.

    Mozos, Stachniss and Burgard, "Supervised Learning of Places from Range Data using AdaBoost",
    ICRA 2005, train and test on scans that are simulated in maps like this.

    Parameters
    ----------
    path : str or sequence of str
        PNG pictures, or GeoJSON files (``.geojson`` or ``.json``) with polygons in metres; see
        ``plan_geojson`` on how their doors and walls are drawn.
    legend : mapping of int to str, optional
        Class of each grey value of a picture. By default 77 room, 115 hallway, 179 doorway.
        Every other value is wall.
    resolution : float or sequence of float
        Side of a pixel, m; one for all plans, or one each. GeoJSON is drawn at this resolution.
    class_property : str
        Property of a GeoJSON polygon that names its class.
    wall_thickness : float
        Thickness of GeoJSON lines that are walls, m.
    mode : {"random", "drive"}
        Poses all over the free space, independent of one another; or along a drive through all
        places that the robot can reach.
    samples : int
        Number of scans in each plan.
    balance : {"area", "class"}
        For random poses: uniform over the free area, or equally many of each class.
    seed : int
        What the poses and the noise are drawn from.
    clearance : float
        Least distance of the robot to a wall, m. It must leave the middle of doors free.
    field_of_view : float
        Angle that the scanner covers, degrees. The angle between beams is field_of_view /
        (beams - 1) under 360, and 360 / beams at 360.
    beams : int
        Number of beams.
    max_range : float
        Longest range of the scanner, m. The default is that of a SICK LMS, as in CARMEN logs.
    noise : float
        Standard deviation of a range, m.
    clutter : mapping of str to float, optional
        Boxes per square metre of each class, such as ``{room: 0.5}``, the same for all samples
        of a plan. None leaves the plan bare; real rooms are not, and a classifier trained on
        bare ones takes them for something else.
    clutter_sizes : sequence of two floats
        Shortest and longest side of a box, m.
    rate : float
        Scans a second, for the stamps and the drive.
    speed : float
        Speed of a drive, m/s.
    turn_rate : float
        How fast the robot turns on the spot, rad/s.
    smoothing : float
        Standard deviation of the Gaussian that rounds the corners of a drive, m.
    spacing : float
        Distance between the points that a drive is planned over, m.
    """

    reads_many = True

    def __init__(
        self,
        path: str | Sequence[str],
        legend: Mapping[int, str] | None = None,
        resolution: float | Sequence[float] = 0.05,
        class_property: str = "class",
        wall_thickness: float = 0.1,
        mode: str = "random",
        samples: int = 1000,
        balance: str = "area",
        seed: int = 0,
        clearance: float = 0.3,
        field_of_view: float = 180.0,
        beams: int = 361,
        max_range: float = 80.0,
        noise: float = 0.01,
        clutter: Mapping[str, float] | None = None,
        clutter_sizes: Sequence[float] = (0.05, 1.0),
        rate: float = 5.0,
        speed: float = 0.5,
        turn_rate: float = 1.0,
        smoothing: float = 0.2,
        spacing: float = 0.1,
    ) -> None:
        self.path = path
        self.legend = legend
        self.resolution = resolution
        self.class_property = class_property
        self.wall_thickness = wall_thickness
        self.mode = mode
        self.samples = samples
        self.balance = balance
        self.seed = seed
        self.clearance = clearance
        self.field_of_view = field_of_view
        self.beams = beams
        self.max_range = max_range
        self.noise = noise
        self.clutter = clutter
        self.clutter_sizes = clutter_sizes
        self.rate = rate
        self.speed = speed
        self.turn_rate = turn_rate
        self.smoothing = smoothing
        self.spacing = spacing

    @property
    def name(self) -> str:  # type: ignore[override]
        """The names of the plans."""
        return "+".join(path.stem for path in self._paths())

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """The plans, and how they were sampled."""
        return {"plans": self.name, "mode": self.mode, "seed": str(self.seed)}

    def __iter__(self) -> Iterator[Observation]:
        self._check()
        number = 0
        for plan in self._plans():
            for observation in self._scans(plan, number):
                yield observation
                number += 1

    def count(self) -> int:
        """Return the number of scans in all plans."""
        return self.samples * len(self._paths())

    def digest(self) -> str:
        """Return a digest of the parameters and the plans."""
        paths = [existing(str(path)) for path in self._paths()]
        parameters = {key: value for key, value in vars(self).items() if key != "path"}
        parameters["names"] = [path.stem for path in paths]
        return digest_of(parameters, paths)

    def _paths(self) -> list[Path]:
        return [Path(self.path)] if isinstance(self.path, str) else [Path(p) for p in self.path]

    def _resolutions(self) -> list[float]:
        """Return the resolution of each plan, m."""
        paths = self._paths()
        if isinstance(self.resolution, (int, float)):
            return [self.resolution] * len(paths)
        if len(self.resolution) != len(paths):
            raise UsageError(
                f"{len(self.resolution)} resolutions for {len(paths)} plans; give one, or one each"
            )
        return list(self.resolution)

    def _plans(self) -> Iterator[Plan]:
        """Yield the plans, one in memory at a time."""
        for path, side in zip(self._paths(), self._resolutions(), strict=True):
            plan = self._read(existing(str(path)), side)
            absent = [c for i, c in enumerate(plan.classes) if not (plan.labels == i).any()]
            if absent:
                log.warning(f"plan {plan.name} has no place of the class {', '.join(absent)}")
            yield self._cluttered(plan)

    def _read(self, path: Path, resolution: float) -> Plan:
        if path.suffix.lower() in (".geojson", ".json"):
            return read_floor(path, self.class_property, resolution, self.wall_thickness)
        return read_picture(path, LEGEND if self.legend is None else self.legend, resolution)

    def _cluttered(self, plan: Plan) -> Plan:
        if not self.clutter:
            return plan
        rng = np.random.default_rng([*self._root(plan), 0, 0])
        return cluttered(plan, self.clutter, self.clutter_sizes, rng)

    def _root(self, plan: Plan) -> list[int]:
        """Return what all random numbers of a plan begin with."""
        return [self.seed, zlib.crc32(plan.name.encode())]

    def _scans(self, plan: Plan, first: int) -> Iterator[Observation]:
        """Yield the observations in one plan; ``first`` is the number of those before it."""
        scanner = Scanner(self.field_of_view, self.beams, self.max_range, self.noise)
        frame = "map" if len(self._paths()) == 1 else plan.name
        for index, (pose, rng) in enumerate(islice(self._poses(plan), self.samples)):
            yield Observation(
                stamp=round((first + index + 1) / self.rate * 1e9),
                scan=scanner.scan(plan.grid, pose, rng),
                pose=Pose2D(pose.x, pose.y, pose.theta, frame),
                label=plan.label_at(pose.x, pose.y),
            )

    def _poses(self, plan: Plan) -> Iterator[tuple[Pose2D, np.random.Generator]]:
        """Yield poses without end, each with its own generator of random numbers."""
        root = self._root(plan)
        if self.mode == "random":
            poses = RandomPoses(plan, self.clearance, self.balance == "class")
            for index in range(self.samples):
                rng = np.random.default_rng([*root, index])
                yield poses.pose(index, rng), rng
        else:
            step, turn = self.speed / self.rate, self.turn_rate / self.rate
            drive = Drive(plan, self.clearance, step, turn, self.smoothing, self.spacing)
            for index, pose in enumerate(drive.poses(np.random.default_rng(root))):
                yield pose, np.random.default_rng([*root, index])

    def _check(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        check_choice("mode", self.mode, MODES)
        check_choice("balance", self.balance, BALANCES)
        for name in ("samples", "beams"):
            check_whole(name, getattr(self, name), least=1)
        check_whole("seed", self.seed, least=0)
        for name in ("field_of_view", "max_range", "rate", "speed", "turn_rate", "spacing"):
            check_number(name, getattr(self, name), above=0)
        for name in ("clearance", "noise", "smoothing", "wall_thickness"):
            check_number(name, getattr(self, name), least=0)
        for name, density in (self.clutter or {}).items():
            check_number(f"clutter of {name}", density, least=0)
        if len(self.clutter_sizes) != 2:
            raise UsageError("clutter_sizes is not two numbers, the shortest and longest side")
        check_number("the shortest of clutter_sizes", self.clutter_sizes[0], above=0)
        check_number("the longest", self.clutter_sizes[1], least=self.clutter_sizes[0])
        for side in self._resolutions():
            check_number("resolution", side, above=0)
