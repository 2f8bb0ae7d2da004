"""The source ``plans``: labelled laser scans in offices and homes that are made up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from placecue.checks import check_choice, check_number, check_whole
from placecue.errors import UsageError
from placecue.observation import LaserScan, Observation, Pose2D
from placecue.source import Source
from placecue_sources.contents import digest_of
from placecue_sources.plan import Plan
from placecue_sources.plans.drawing import drawn_plan
from placecue_sources.plans.style import STYLES, drawn
from placecue_sources.random_poses import RandomPoses
from placecue_sources.scanner import Scanner

#: Changes when the same seed draws other plans or scans.
VERSION = 1


class Plans(Source):
    """A robot with a laser scanner at random poses in floor plans that a seed decides.

    Offices and homes with rooms, corridors and doorways (the classes ``room``, ``corridor``,
    ``doorway``): corridors that are single, branched or a ring, narrow or a hall; small rooms,
    large ones, ones behind others and ones in the shape of an L; bare or furnished, with doors
    that stand open, panes of glass and uneven walls; square, askew or bent. Every plan has a
    scanner of its own, between the limits that are given.

    Each plan depends on the seed and its number alone, each sample on its own number too, so
    iterating again gives the same. Poses are in the plan's own coordinates, in a frame of its
    name, and a plan is a group of its own (``scene``) to folds that keep scenes together.

    Parameters
    ----------
    plans : int
        Number of plans.
    samples : int
        Number of scans in each, equally many of each class.
    seed : int
        What everything is drawn from.
    styles : sequence of str
        Kinds of buildings, in turn: ``office``, ``home``.
    field_of_view : sequence of float
        Angles that scanners cover, degrees; a plan has one of them.
    beams_per_degree : sequence of two floats
        Fewest and most beams a degree.
    max_range : sequence of two floats
        Shortest and longest range of a scanner, m; lengths between are drawn on a log scale.
    noise : sequence of two floats
        Least and largest standard deviation of a range, m.
    missing : float
        Largest share of beams that come back from nothing.
    clearance : float
        Least distance of the robot to a wall, m.
    resolution : float
        Side of the cells that plans are drawn in, m.
    rate : float
        Scans a second, for the stamps.
    """

    def __init__(
        self,
        plans: int = 100,
        samples: int = 90,
        seed: int = 0,
        styles: Sequence[str] = ("office", "office", "home"),
        field_of_view: Sequence[float] = (180.0, 270.0, 360.0),
        beams_per_degree: Sequence[float] = (1.0, 3.0),
        max_range: Sequence[float] = (8.0, 80.0),
        noise: Sequence[float] = (0.003, 0.03),
        missing: float = 0.05,
        clearance: float = 0.25,
        resolution: float = 0.05,
        rate: float = 5.0,
    ) -> None:
        self.plans = plans
        self.samples = samples
        self.seed = seed
        self.styles = styles
        self.field_of_view = field_of_view
        self.beams_per_degree = beams_per_degree
        self.max_range = max_range
        self.noise = noise
        self.missing = missing
        self.clearance = clearance
        self.resolution = resolution
        self.rate = rate

    @property
    def name(self) -> str:  # type: ignore[override]
        """What the plans are decided by."""
        return f"plans_{self.seed}"

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """How many plans of what kind there are."""
        return {"plans": str(self.plans), "styles": ", ".join(self.styles), "seed": str(self.seed)}

    def __iter__(self) -> Iterator[Observation]:
        self.check()
        for number in range(self.plans):
            yield from self._scans(number)

    def count(self) -> int:
        """Return the number of scans in all plans."""
        return self.plans * self.samples

    def digest(self) -> str:
        """Return a digest of the parameters and the generator's version."""
        return digest_of({**vars(self), "version": VERSION}, [])

    def plan(self, number: int) -> Plan:
        """Draw one of the plans.

        Parameters
        ----------
        number : int
            Which of them, from 0.
        """
        style = self.styles[number % len(self.styles)]
        rng = np.random.default_rng([self.seed, number, 0])
        return drawn_plan(f"{style}_{number}", style, self.resolution, rng)

    def _scans(self, number: int) -> Iterator[Observation]:
        plan = self.plan(number)
        scanner = self._scanner(np.random.default_rng([self.seed, number, 1]))
        missing = np.random.default_rng([self.seed, number, 2]).uniform(0, self.missing)
        poses = RandomPoses(plan, self.clearance, by_class=True)
        for index in range(self.samples):
            rng = np.random.default_rng([self.seed, number, 3, index])
            pose = poses.pose(index, rng)
            scan = scanner.scan(plan.grid, pose, rng)
            yield Observation(
                stamp=round((number * self.samples + index + 1) / self.rate * 1e9),
                scan=_without(scan, missing, rng),
                pose=Pose2D(pose.x, pose.y, pose.theta, plan.name),
                label=plan.label_at(pose.x, pose.y),
                scene=plan.name,
            )

    def _scanner(self, rng: np.random.Generator) -> Scanner:
        degrees = float(self.field_of_view[int(rng.integers(len(self.field_of_view)))])
        low, high = self.beams_per_degree
        beams = max(2, round(degrees * float(rng.uniform(low, high))))
        reach = drawn((self.max_range[0], self.max_range[1]), rng)
        return Scanner(degrees, beams, reach, float(rng.uniform(self.noise[0], self.noise[1])))

    def check(self) -> None:
        """Raise UsageError for parameters that cannot be."""
        for name in ("plans", "samples"):
            check_whole(name, getattr(self, name), least=1)
        check_whole("seed", self.seed, least=0)
        for name in ("styles", "field_of_view"):
            if isinstance(getattr(self, name), str) or not list(getattr(self, name)):
                raise UsageError(f"{name} is no list: give [one, or, more]")
        for style in self.styles:
            check_choice("a style", style, tuple(STYLES))
        for degrees in self.field_of_view:
            check_number("field_of_view", degrees, above=0, most=360)
        for name in ("beams_per_degree", "max_range", "noise"):
            self._check_limits(name)
        check_number("missing", self.missing, least=0, below=1)
        check_number("clearance", self.clearance, least=0)
        for name in ("resolution", "rate"):
            check_number(name, getattr(self, name), above=0)

    def _check_limits(self, name: str) -> None:
        limits = getattr(self, name)
        if isinstance(limits, str) or not isinstance(limits, Sequence) or len(limits) != 2:
            raise UsageError(f"{name} is {limits!r}; give two numbers, the least and the largest")
        if name == "noise":
            check_number("the least noise", limits[0], least=0)
        else:
            check_number(f"the least {name}", limits[0], above=0)
        check_number(f"the largest {name}", limits[1], least=limits[0])


def _without(scan: LaserScan, share: float, rng: np.random.Generator) -> LaserScan:
    """Return a scan of which runs of beams, so large a share in all, measured nothing."""
    n = scan.ranges.size
    ranges = np.array(scan.ranges)
    for _ in range(rng.poisson(share * n / 6)):
        start, length = int(rng.integers(n)), int(rng.integers(1, 12))
        ranges[start : start + length] = np.inf
    if not np.isfinite(ranges).any():  # one beam is left in any case
        return scan
    return replace(scan, ranges=ranges)
