"""The ``office`` source: a robot with camera and laser that drives through a drawn building."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from functools import cached_property, partial
from inspect import signature
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from placecue.errors import UsageError, choices
from placecue.observation import Image, Observation, Pose2D
from placecue.source import Source
from placecue_sources.checks import check_choice, check_number, check_whole
from placecue_sources.office.camera import Camera
from placecue_sources.office.drive import odometry, sample
from placecue_sources.office.laser import Laser
from placecue_sources.office.light import ILLUMINATIONS
from placecue_sources.office.plan_file import read_plan
from placecue_sources.office.world import BEAMS, PIXELS, WHEELS, World

PLANS = Path(__file__).parent

#: Changes whenever the same parameters give other observations.
VERSION = 1

#: What may be given as the pose.
POSES = ("odometry", "truth")

_WHOLE = {"seed": 0, "run": 0, "width": 1, "height": 1, "beams": 1}
_POSITIVE = (
    *("rate", "speed", "turn_rate", "field_of_view", "camera_height"),
    *("laser_field_of_view", "max_range", "robot_radius", "robot_height"),
)


class Office(Source):
    """A simulated office floor: images, scans, odometry and labels of a drive through it.

    The world is the floor on which IDOL2 was recorded (Luo, Pronobis, Caputo, Jensfelt, KTH,
    2006), redrawn: two offices, a corridor, a kitchen and a printer area, in IDOL2's coordinates.
    Everything is decided by the parameters, to the byte. Images are rendered when they are
    looked at.

    Parameters
    ----------
    world : str
        Name of a plan that is shipped, or the path of a ``.geojson`` file.
    seed : int
        The world: what its things look like.
    run : int
        The drive: the way taken, and where chairs and boxes stand.
    illumination : str
        ``cloudy``, ``night`` or ``sunny``.
    samples : int or None
        Observations after which the drive ends; None drives the whole tour.
    rate : float
        Observations a second.
    speed : float
        Speed on a straight, m/s.
    turn_rate : float
        Fastest turn, rad/s.
    width, height : int
        Size of the image, pixels.
    field_of_view : float
        Horizontal, of the camera, degrees.
    camera_height : float
        m.
    image_noise : float
        Standard deviation of the camera's noise, grey levels.
    beams : int
        Number of laser beams.
    laser_field_of_view : float
        Degrees, up to 360.
    laser_height : float
        m.
    max_range : float
        Longest length that the laser measures, m.
    range_noise : float
        Standard deviation of the laser's lengths, m.
    pose : str
        ``odometry`` gives what the wheels say (frame ``odom``, which begins on the plan), ``truth``
        the true pose (frame ``map``).
    drift : float
        Errors of the odometry, as a part of the way and the turns.
    robot_radius, robot_height : float
        What has to fit through, m.
    start : float
        Time of the first observation, s.
    """

    def __init__(
        self,
        world: str = "idol2_floor",
        seed: int = 0,
        run: int = 1,
        illumination: str = "cloudy",
        samples: int | None = None,
        rate: float = 5.0,
        speed: float = 1.0,
        turn_rate: float = 1.2,
        width: int = 320,
        height: int = 240,
        field_of_view: float = 68.0,
        camera_height: float = 1.0,
        image_noise: float = 3.0,
        beams: int = 361,
        laser_field_of_view: float = 180.0,
        laser_height: float = 0.3,
        max_range: float = 30.0,
        range_noise: float = 0.005,
        pose: str = "odometry",
        drift: float = 0.01,
        robot_radius: float = 0.3,
        robot_height: float = 1.2,
        start: float = 1.7e9,
    ) -> None:
        self.world = world
        self.seed = seed
        self.run = run
        self.illumination = illumination
        self.samples = samples
        self.rate = rate
        self.speed = speed
        self.turn_rate = turn_rate
        self.width = width
        self.height = height
        self.field_of_view = field_of_view
        self.camera_height = camera_height
        self.image_noise = image_noise
        self.beams = beams
        self.laser_field_of_view = laser_field_of_view
        self.laser_height = laser_height
        self.max_range = max_range
        self.range_noise = range_noise
        self.pose = pose
        self.drift = drift
        self.robot_radius = robot_radius
        self.robot_height = robot_height
        self.start = start

    @property
    def name(self) -> str:  # type: ignore[override]
        """World, light and run, such as ``idol2_floor_cloudy1``."""
        return f"{Path(self.world).stem}_{self.illumination}{self.run}"

    @property
    def metadata(self) -> Mapping[str, str]:  # type: ignore[override]
        """World, illumination, run and seed."""
        return {
            "world": Path(self.world).stem,
            "illumination": self.illumination,
            "run": str(self.run),
            "seed": str(self.seed),
        }

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations of the drive.

        Raises
        ------
        UsageError
            If a parameter has an impossible value.
        """
        built, given = self.built, self._given_poses
        faces = built.faces_at(self.laser_height)
        laser = Laser(self.beams, self.laser_field_of_view, self.max_range, self.range_noise)
        frame = "map" if self.pose == "truth" else "odom"
        for index, (x, y, theta) in enumerate(self.true_poses.tolist()):
            true = Pose2D(x, y, theta, "map")
            yield Observation(
                self.stamp(index),
                image=partial(self.render, true, index),
                scan=laser.scan(faces, true, built.rng(BEAMS, index)),
                pose=_pose(given[index], frame),
                label=built.label_at(x, y),
            )

    def render(self, pose: Pose2D, index: int = 0) -> Image:
        """Take the image of a true pose.

        Parameters
        ----------
        pose : Pose2D
            Where the robot is in the plan.
        index : int
            Decides the sensor's noise.

        Returns
        -------
        ndarray of uint8, shape (height, width, 3)
            RGB.
        """
        built = self.built
        camera = Camera(
            self.width, self.height, self.field_of_view, self.camera_height, self.image_noise
        )
        key = int(built.rng(PIXELS, index).integers(2**63))
        return camera.shoot(built.geometry, built.skin, built.ground, pose, key)

    def stamp(self, index: int) -> int:
        """Return the time of an observation, ns."""
        return round(self.start * 1e9) + round(index * 1e9 / self.rate)

    def count(self) -> int:
        """Return the number of observations."""
        return len(self.true_poses)

    def digest(self) -> str:
        """Return a digest of the parameters, the plan and the simulator's version."""
        given = {name: getattr(self, name) for name in _parameters()} | {"version": VERSION}
        text = json.dumps(given, sort_keys=True).encode() + self._plan_file.read_bytes()
        return hashlib.sha256(text).hexdigest()

    @cached_property
    def built(self) -> World:
        """The world of this run."""
        self._check()
        return World(
            read_plan(self._plan_file),
            self.seed,
            self.run,
            self.illumination,
            self.robot_radius,
            self.robot_height,
        )

    @property
    def true_poses(self) -> NDArray[np.float64]:
        """Where the robot is: x, y in m and heading in rad, shape (n, 3)."""
        return self._drive[: self.samples]

    @cached_property
    def _drive(self) -> NDArray[np.float64]:
        return sample(self.built.drive(self.speed, self.turn_rate), self.rate)[:, 1:]

    @cached_property
    def _given_poses(self) -> NDArray[np.float64]:
        if self.pose == "truth":
            return self._drive
        return odometry(self._drive, self.drift, self.built.rng(WHEELS))

    @property
    def _plan_file(self) -> Path:
        if self.world.endswith(".geojson"):
            return Path(self.world)
        plans = {path.stem: path for path in PLANS.glob("*.geojson")}
        if self.world not in plans:
            raise UsageError(
                f"no world '{self.world}': {choices(self.world, plans)}; a plan of your own is "
                "given as the path of its .geojson file"
            )
        return plans[self.world]

    def _check(self) -> None:
        check_choice("illumination", self.illumination, tuple(ILLUMINATIONS))
        check_choice("pose", self.pose, POSES)
        for name, least in _WHOLE.items():
            check_whole(name, getattr(self, name), least=least)
        if self.samples is not None:
            check_whole("samples", self.samples, least=1)
        for name in _POSITIVE:
            check_number(name, getattr(self, name), above=0.0)


def _pose(values: NDArray[np.float64], frame: str) -> Pose2D:
    x, y, theta = values.tolist()
    return Pose2D(x, y, theta, frame)


def _parameters() -> list[str]:
    return list(signature(Office).parameters)
