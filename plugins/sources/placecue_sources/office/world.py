"""A plan in one run and one light, built no further than it is looked at."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError
from placecue_sources.office.arrange import arrange
from placecue_sources.office.arrays import Geometry, Ground, Skin
from placecue_sources.office.blocks import Block, blocks_of
from placecue_sources.office.drive import follow
from placecue_sources.office.light import ILLUMINATIONS, light_up
from placecue_sources.office.plan import Plan, Points
from placecue_sources.office.route import Clearance, plan_route
from placecue_sources.office.scene import build_geometry, build_skin

#: Distances of the point that is steered at, m.
LOOKAHEADS = (0.25, 0.18, 0.12, 0.08)

#: What chance decides, each by a generator of its own.
ARRANGING, ROUTING, WHEELS, BEAMS, PIXELS = range(5)


class World:
    """Everything that does not change during a run.

    Parameters
    ----------
    plan : Plan
        The building.
    seed : int
        Decides what things look like.
    run : int
        With the seed, decides where movable things stand and the way that the robot takes.
    illumination : str
        Name of the light.
    robot_radius, robot_height : float
        Size of the robot, m.
    """

    def __init__(
        self,
        plan: Plan,
        seed: int,
        run: int,
        illumination: str,
        robot_radius: float,
        robot_height: float,
    ) -> None:
        self.plan = plan
        self.seed = seed
        self.run = run
        self.illumination = illumination
        self.robot_radius = robot_radius
        self.robot_height = robot_height

    def rng(self, purpose: int, *index: int) -> np.random.Generator:
        """Return the generator of one purpose (and moment) of this run."""
        return np.random.default_rng([self.seed, self.run, purpose, *index])

    @cached_property
    def blocks(self) -> list[Block]:
        """What stands in the building in this run."""
        furniture = arrange(self.plan, self.rng(ARRANGING), clear=self.robot_radius + 0.15)
        return blocks_of(self.plan, furniture)

    @cached_property
    def geometry(self) -> Geometry:
        """Where its surfaces are."""
        return build_geometry(self.plan, self.blocks)

    @cached_property
    def skin(self) -> Skin:
        """What its surfaces look like."""
        return build_skin(self.plan, self.blocks, self.seed)

    @cached_property
    def ground(self) -> Ground:
        """Rooms and light by place."""
        light = ILLUMINATIONS[self.illumination]
        return light_up(self.plan, self.blocks, self.geometry, light)

    @cached_property
    def clearance(self) -> Clearance:
        """How far it is to the nearest obstacle."""
        return Clearance.around(self.plan, self.blocks, self.robot_height)

    @cached_property
    def route(self) -> Points:
        """The way of this run, m, shape (n, 2)."""
        return plan_route(self.plan, self.clearance, self.robot_radius, self.rng(ROUTING))

    def drive(self, speed: float, turn_rate: float) -> NDArray[np.float64]:
        """Return the states of a robot on the route, as :func:`follow` does, shape (k, 4).

        It follows as loosely as it may without touching anything.

        Raises
        ------
        DataError
            If it bumps into something however closely it follows.
        """
        for lookahead in LOOKAHEADS:
            states = follow(self.route, speed, turn_rate, lookahead)
            if self.clearance.at(states[:, 1:3]).min() > self.robot_radius:
                return states
        raise DataError(
            f"a robot of radius {self.robot_radius} m at {speed} m/s bumps into something in plan "
            f"'{self.plan.name}', run {self.run}: make it slower or smaller, or turn faster"
        )

    def label_at(self, x: float, y: float) -> str | None:
        """Return the label of the room at a position, None outside all rooms."""
        room = int(self.plan.room_at(np.array([[x, y]]))[0])
        return None if room < 0 else self.plan.rooms[room].label

    def faces_at(self, height: float) -> NDArray[np.float64]:
        """Return what a horizontal plane cuts, x0, y0, x1, y1 in m, shape (k, 4)."""
        return self.geometry.cut(height)
