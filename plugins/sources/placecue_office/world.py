"""A plan in one recording, built no further than it is looked at."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue_office.aging import Aging
from placecue_office.arrange import arrange, rescattered
from placecue_office.arrays import Geometry, Ground, Skin
from placecue_office.blocks import Block, blocks_of
from placecue_office.clutter import Clutter
from placecue_office.drive import follow
from placecue_office.explore import Explorer
from placecue_office.floor import Floor
from placecue_office.light import ILLUMINATIONS, light_up
from placecue_office.people import AWAY, Walk, Walkers, at_place, sit_down, standing
from placecue_office.plan import Furniture, Plan, Points
from placecue_office.route import Clearance, Planner, plan_route
from placecue_office.scene import build_geometry, build_skin

#: Distances of the point that is steered at, m.
LOOKAHEADS = (0.25, 0.18, 0.12, 0.08)

#: Distances that a way keeps from everything beyond the robot's radius, m: the first that do.
MARGINS = (0.005, 0.02, 0.04)

#: What chance decides in a recording, each by a generator of its own.
ARRANGING, ROUTING, WHEELS, BEAMS, PIXELS, LIGHT, SEATS, CLOTHES, WALKS = range(9)

#: What chance decides in a world, for all recordings of a time.
SCATTERING, AGING, WEEKS, HOURS = 100, 101, 102, 103

#: Drives with the same last digit were recorded close together, others weeks apart.
DRIVES = 10

#: Strides of a walker a second, and how far a foot is ahead, m.
STRIDES, STRIDE = 0.9, 0.3


@dataclass(frozen=True, slots=True)
class Recording:
    """Which of the recordings of a world it is.

    Parameters
    ----------
    seed : int
        Decides what things look like and where they stand.
    half_years : int
        How often things have been exchanged since the first recording.
    drive : int
        Decides the way taken, what was moved since the drive before, and who is about.
    illumination : str
        Name of the light.
    """

    seed: int
    half_years: int
    drive: int
    illumination: str

    def rng(self, purpose: int, *index: int) -> np.random.Generator:
        """Return the generator of one purpose (and moment) of this recording."""
        return np.random.default_rng([self.seed, self.drive, purpose, *index])

    def rng_of_world(self, purpose: int, *time: int) -> np.random.Generator:
        """Return a generator that all recordings of the world at a time share."""
        return np.random.default_rng([self.seed, purpose, *time])


@dataclass(frozen=True, slots=True)
class Life:
    """How much goes on in a world.

    Parameters
    ----------
    clutter : int
        How many small things stand about.
    moved : float
        Part of them that is put elsewhere from one recording to the next.
    moved_in_weeks : float
        Part of them that is put elsewhere from the recordings in one light to those in another.
    moved_later : float
        Part of them that is put elsewhere in half a year.
    added : int
        Boxes that come in half a year.
    box : (float, float)
        Shortest and longest side of these, m.
    walkers : int
        How many people walk about.
    seated : float
        Part of the chairs that somebody sits on.
    """

    clutter: int = 15
    moved: float = 0.35
    moved_in_weeks: float = 0.25
    moved_later: float = 0.8
    added: int = 8
    box: tuple[float, float] = (0.35, 0.7)
    walkers: int = 2
    seated: float = 0.12


class World:
    """Everything that does not change during a recording.

    Parameters
    ----------
    plan : Plan
        The building, as it is drawn.
    recording : Recording
    life : Life
    way : ndarray, shape (n, 2)
        Points that nothing is put near, m.
    clear : float
        How near, m.
    robot_radius, robot_height : float
        Size of the robot, m.
    """

    def __init__(
        self,
        plan: Plan,
        recording: Recording,
        life: Life,
        way: Points,
        clear: float,
        robot_radius: float,
        robot_height: float,
    ) -> None:
        self.drawn = plan
        self.recording = recording
        self.life = life
        self.way = way
        self.clear = clear
        self.robot_radius = robot_radius
        self.robot_height = robot_height

    @cached_property
    def _of_this_time(self) -> tuple[Plan, Floor, list[Furniture]]:
        """The plan, its floor and the clutter on it, as recordings of this time share them."""
        plan, clutter, life = self.drawn, Clutter(), self.life
        floor = Floor(plan, self.way, self.clear)
        rng = self.recording.rng_of_world(SCATTERING, 0)
        things = clutter.scattered(floor, life.clutter, rng)
        for half_year in range(1, self.recording.half_years + 1):
            rng = self.recording.rng_of_world(AGING, half_year)
            plan = Aging().later(plan, floor, rng)
            things = rescattered(things, life.moved_later, clutter, floor, rng)
            boxes = Clutter(sizes=life.box)
            things += boxes.scattered(floor, life.added, rng, first=1000 * half_year)
        rng = self.recording.rng_of_world(WEEKS, *self._weeks)
        things = rescattered(things, life.moved_in_weeks, clutter, floor, rng)
        return plan, floor, things

    @property
    def _weeks(self) -> tuple[int, int]:
        """What recordings that are made close together share: half-year, and kind of drive."""
        return self.recording.half_years, self.recording.drive % DRIVES

    @property
    def plan(self) -> Plan:
        """The building, as it was at the time of the recording."""
        return self._of_this_time[0]

    @cached_property
    def blocks(self) -> list[Block]:
        """What stands in the building in this recording."""
        plan, floor, things = self._of_this_time
        rng = self.recording.rng(ARRANGING)
        furniture = arrange(plan.furniture, floor, rng)
        things = rescattered(things, self.life.moved, Clutter(), floor, rng)
        sitting = sit_down(furniture, floor, self.life.seated, self.recording.rng(SEATS))
        return blocks_of(plan, (*furniture, *things)) + sitting

    @cached_property
    def _figures(self) -> list[list[Block]]:
        """Who walks about: each at the origin."""
        rng = self.recording.rng(CLOTHES)
        return [standing(rng) for _ in range(self.life.walkers)]

    @cached_property
    def geometry(self) -> Geometry:
        """Where its surfaces are, while nobody walks about."""
        away = [at_place(block, AWAY) for figure in self._figures for block in figure]
        return build_geometry(self.plan, self.blocks + away)

    def geometry_at(self, time: float, walks: Sequence[Sequence[Walk]]) -> Geometry:
        """Return where surfaces are at a time (s), with the walkers on their walks."""
        places = [_place(each, time) for each in walks]
        if all(place == AWAY for place in places):
            return self.geometry
        walking = []
        for number, place in enumerate(places):
            swing = STRIDE * np.sin(2 * np.pi * STRIDES * time + number)
            figure = standing(np.random.default_rng(0), float(swing))  # of any clothes: a shape
            walking += [at_place(block, place).outline for block in figure]
        faces = self.geometry.faces.copy()
        edges = [np.hstack([each, np.roll(each, -1, axis=0)]) for each in walking]
        faces[len(faces) - sum(map(len, edges)) :] = np.vstack(edges)
        return self.geometry._replace(faces=faces)

    def walks(self, times: NDArray[np.float64], drive: NDArray[np.float64]) -> list[list[Walk]]:
        """Return the walks of everybody who walks about during a drive."""
        walkers, rng = Walkers(), self.recording.rng(WALKS)
        if not self.life.walkers:
            return []
        planner = Planner(self.plan, self.clearance, walkers.radius, rng)
        return [
            walkers.walks(self.plan, planner, times, drive, rng) for _ in range(self.life.walkers)
        ]

    @cached_property
    def skin(self) -> Skin:
        """What its surfaces look like."""
        everybody = [block for figure in self._figures for block in figure]
        return build_skin(self.plan, self.blocks + everybody, self.recording.seed)

    @cached_property
    def ground(self) -> Ground:
        """Rooms and light by place."""
        light, here = ILLUMINATIONS[self.recording.illumination], self.recording
        usual = here.rng_of_world(HOURS, *self._weeks)
        return light_up(self.plan, self.blocks, self.geometry, light, here.rng(LIGHT), usual)

    @cached_property
    def clearance(self) -> Clearance:
        """How far it is to the nearest obstacle."""
        return Clearance.around(self.plan, self.blocks, self.robot_height)

    def planned_route(self, margin: float) -> Points:
        """Return a way through the places of the plan's tour, m, shape (n, 2).

        Parameters
        ----------
        margin : float
            Distance that it keeps from everything beyond the robot's radius, m.
        """
        rng = self.recording.rng(ROUTING)
        return plan_route(self.plan, self.clearance, self.robot_radius, rng, margin=margin)

    def explored_route(self, laser_height: float, margin: float) -> Points:
        """Return the way of a robot that explores from where the tour begins, m, shape (n, 2)."""
        rng = self.recording.rng(ROUTING)
        planner = Planner(self.plan, self.clearance, self.robot_radius + margin, rng)
        return Explorer(planner, self.geometry.cut(laser_height)).explore(self.plan.tour[0])

    def drive(
        self, route: Callable[[float], Points], speed: float, turn_rate: float
    ) -> NDArray[np.float64]:
        """Return the states of a robot on a route, as :func:`follow` does, shape (k, 4).

        It follows as loosely as it may without touching anything.

        Parameters
        ----------
        route : callable
            Gives the way that keeps a margin (m), as :meth:`planned_route` does.
        speed, turn_rate : float
            m/s and rad/s.

        Raises
        ------
        DataError
            If there is no way, or it bumps into something however closely it follows.
        """
        for margin in MARGINS:
            way = route(margin)
            for lookahead in LOOKAHEADS:
                states = follow(way, speed, turn_rate, lookahead)
                if self.clearance.at(states[:, 1:3]).min() > self.robot_radius:
                    return states
        raise DataError(
            f"a robot of radius {self.robot_radius} m at {speed} m/s bumps into something in plan "
            f"'{self.plan.name}', drive {self.recording.drive}: make it slower or smaller, or turn "
            "faster"
        )

    def label_at(self, x: float, y: float) -> str | None:
        """Return the label of the room at a position, None outside all rooms."""
        room = int(self.plan.room_at(np.array([[x, y]]))[0])
        return None if room < 0 else self.plan.rooms[room].label


def _place(walks: Sequence[Walk], time: float) -> tuple[float, float, float]:
    places = (walk.at(time) for walk in walks)
    return next((place for place in places if place != AWAY), AWAY)
