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

from placecue.camera import PinholeCamera
from placecue.checks import check_choice, check_number, check_whole
from placecue.errors import UsageError
from placecue.observation import Image, Observation, Pose2D
from placecue.source import Source
from placecue_office.arrays import Geometry
from placecue_office.camera import Camera
from placecue_office.drive import odometry, sample
from placecue_office.exposure import Exposure
from placecue_office.floor import dense
from placecue_office.laser import Laser
from placecue_office.light import ILLUMINATIONS
from placecue_office.people import Walk
from placecue_office.plan_file import find_plan, read_plan
from placecue_office.recorded import Drive, all_positions, find_poses, recorded_drive
from placecue_office.world import BEAMS, PIXELS, WHEELS, Life, Recording, World

#: Of the world: changes whenever the same parameters give other observations, so that results
#: on different ones are not compared. Figures of docs/benchmark.md are of this one.
VERSION = 3

#: What may be given as the pose.
POSES = ("odometry", "truth")

#: How the robot may find its way.
ROUTES = ("planned", "idol2", "explore")

#: Distance beyond the robot's radius that things keep from the lines of the tour, m.
ASIDE = 0.15

#: Pixels along a side, what JPEG can hold, and in an image, which takes 20 bytes each to render.
_SIDE, _PIXELS = 65_500, 100_000_000

_WHOLE = {
    **{"seed": 0, "run": 0, "width": 1, "height": 1, "beams": 1},
    **{"runs_together": 1, "clutter": 0, "walkers": 0},
}
_PARTS = ("seated", "shutter", "exposure_lag", "image_noise", "range_noise", "drift")
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
        Which recording: another way taken, chairs, boxes and papers moved.
    illumination : str
        ``cloudy``, ``night`` or ``sunny``; another recording too, unless ``drive`` is given.
    drive : int or None
        Decides the way taken and what was moved; None gives every run in every illumination a
        drive of its own.
    runs_together : int
        So many runs are recorded close in time; before the next ones furniture and posters are
        exchanged ("half a year later").
    route : str
        ``planned``: through the places of the plan's tour; ``idol2``: the drives recorded there;
        ``explore``: by itself (Yamauchi, CIRA 1997).
    poses : str or None
        The recorded poses (``poses.csv.gz``); None looks in the folder ``PLACECUE_DATA``.
    clutter : int
        How many small things stand about; a third is put elsewhere in each recording.
    walkers : int
        How many people walk about.
    seated : float
        Part of the chairs that somebody sits on.
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
    shutter : float
        Time that the shutter is open at an exposure of 1, s: it blurs what the robot turns past.
    exposure_lag : float
        Time that the automatic exposure takes to follow, s.
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
        Time of the first observation, s; a recorded drive has its own times.
    """

    def __init__(
        self,
        world: str = "idol2_floor",
        seed: int = 0,
        run: int = 1,
        illumination: str = "cloudy",
        drive: int | None = None,
        runs_together: int = 2,
        route: str = "planned",
        poses: str | None = None,
        clutter: int = 15,
        walkers: int = 2,
        seated: float = 0.12,
        samples: int | None = None,
        rate: float = 5.0,
        speed: float = 1.0,
        turn_rate: float = 1.2,
        width: int = 320,
        height: int = 240,
        field_of_view: float = 68.0,
        camera_height: float = 1.0,
        image_noise: float = 3.0,
        shutter: float = 0.008,
        exposure_lag: float = 0.3,
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
        self.drive = drive
        self.runs_together = runs_together
        self.route = route
        self.poses = poses
        self.clutter = clutter
        self.walkers = walkers
        self.seated = seated
        self.samples = samples
        self.rate = rate
        self.speed = speed
        self.turn_rate = turn_rate
        self.width = width
        self.height = height
        self.field_of_view = field_of_view
        self.camera_height = camera_height
        self.image_noise = image_noise
        self.shutter = shutter
        self.exposure_lag = exposure_lag
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
        """What the recording is, so that sequences can be paired by rule.

        Worlds of the same seed are the same within a version.
        """
        return {
            "dataset": "office",
            "world": Path(self.world).stem,
            "version": str(VERSION),
            "seed": str(self.seed),
            "illumination": self.illumination,
            "run": str(self.run),
            "half_years": str(self.half_years),
            "route": self.route,
        }

    @property
    def camera(self) -> PinholeCamera:  # type: ignore[override]
        """The camera; the middle of the image is on its axis."""
        focal = float(0.5 * self.width / np.tan(np.radians(0.5 * self.field_of_view)))
        middle = (self.width / 2, self.height / 2)
        return PinholeCamera(self.width, self.height, focal, focal, *middle)

    @property
    def half_years(self) -> int:
        """How often furniture and posters have been exchanged since the first run."""
        return max(self.run - 1, 0) // self.runs_together

    def __iter__(self) -> Iterator[Observation]:
        """Yield the observations of the drive.

        Raises
        ------
        UsageError
            If a parameter has an impossible value.
        """
        built, given = self.built, self._given_poses
        laser = Laser(self.beams, self.laser_field_of_view, self.max_range, self.range_noise)
        frame = "map" if self.pose == "truth" else "odom"
        for index, (x, y, theta) in enumerate(self.true_poses.tolist()):
            true = Pose2D(x, y, theta, "map")
            faces = self.geometry(index).cut(self.laser_height)
            yield Observation(
                self.stamp(index),
                image=partial(self.render, true, index),
                scan=laser.scan(faces, true, built.recording.rng(BEAMS, index)),
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
            Which observation it belongs to: decides the noise, the exposure, and who is about.

        Returns
        -------
        ndarray of uint8, shape (height, width, 3)
            RGB.
        """
        built = self.built
        key = int(built.recording.rng(PIXELS, index).integers(2**63))
        return self.renderer.shoot(
            self.geometry(index),
            built.skin,
            built.ground,
            pose,
            key,
            self.exposure(index),
            self._turning[index],
        )

    @property
    def renderer(self) -> Camera:
        """What takes the pictures of the robot's camera."""
        return Camera(
            *(self.width, self.height, self.field_of_view, self.camera_height, self.image_noise),
            shutter=self.shutter,
        )

    def exposure(self, index: int) -> float:
        """Return the camera's exposure at an observation."""
        return self._exposures.at(index, self._metered)

    @cached_property
    def _exposures(self) -> Exposure:
        return Exposure(self._times, self.exposure_lag)

    def _metered(self, index: int) -> float:
        pose = _pose(self._drive.poses[index], "map")
        built, geometry = self.built, self.geometry(index)
        return self.renderer.meter(geometry, built.skin, built.ground, pose)

    def geometry(self, index: int) -> Geometry:
        """Return what stands where at an observation, walkers included."""
        return self.built.geometry_at(float(self._times[index]), self._walks)

    def stamp(self, index: int) -> int:
        """Return the time of an observation, ns."""
        if self.route == "idol2":
            return round(float(self._drive.stamps[index]) * 1e6) * 1000
        return round(self.start * 1e9) + round(index * 1e9 / self.rate)

    def count(self) -> int:
        """Return the number of observations."""
        return len(self.true_poses)

    def digest(self) -> str:
        """Return a digest of the parameters, the plan and the simulator's version."""
        given = {name: getattr(self, name) for name in signature(Office).parameters}
        text = (
            json.dumps(given | {"version": VERSION}, sort_keys=True).encode()
            + find_plan(self.world).read_bytes()
        )
        if self.route == "idol2":
            text += self._drive.stamps.tobytes() + self._drive.poses.tobytes()
        return hashlib.sha256(text).hexdigest()

    @cached_property
    def built(self) -> World:
        """The world of this recording."""
        self._check()
        plan, radius = read_plan(find_plan(self.world)), self.robot_radius
        check_number("camera_height", self.camera_height, below=plan.height)
        recorded = self.route == "idol2"
        way = all_positions(find_poses(self.poses)) if recorded else dense(plan.tour)
        return World(
            plan,
            Recording(self.seed, self.half_years, self._drive_number, self.illumination),
            Life(clutter=self.clutter, walkers=self.walkers, seated=self.seated),
            way,
            radius if recorded else radius + ASIDE,
            radius,
            self.robot_height,
        )

    @property
    def _drive_number(self) -> int:
        if self.drive is not None:
            return self.drive
        return 10 * self.run + list(ILLUMINATIONS).index(self.illumination)

    @property
    def true_poses(self) -> NDArray[np.float64]:
        """Where the robot is: x, y in m and heading in rad, shape (n, 3)."""
        return self._drive.poses[: self.samples]

    @cached_property
    def _drive(self) -> Drive:
        built = self.built
        if self.route == "idol2":
            return recorded_drive(find_poses(self.poses), self.illumination, self.run)
        explored = partial(built.explored_route, self.laser_height)
        route = explored if self.route == "explore" else built.planned_route
        states = sample(built.drive(route, self.speed, self.turn_rate), self.rate)
        return Drive(states[:, 0], states[:, 1:])

    @cached_property
    def _times(self) -> NDArray[np.float64]:
        """Seconds since the drive began, shape (n,)."""
        return np.asarray(self._drive.stamps - self._drive.stamps[0])

    @cached_property
    def _turning(self) -> NDArray[np.float64]:
        """How fast the robot turns, rad/s, shape (n,)."""
        return np.gradient(self._drive.poses[:, 2], self._times)

    @cached_property
    def _walks(self) -> list[list[Walk]]:
        return self.built.walks(self._times, self._drive.poses)

    @cached_property
    def _given_poses(self) -> NDArray[np.float64]:
        if self.pose == "truth":
            return self._drive.poses
        return odometry(self._drive.poses, self.drift, self.built.recording.rng(WHEELS))

    def _check(self) -> None:
        check_choice("illumination", self.illumination, tuple(ILLUMINATIONS))
        check_choice("pose", self.pose, POSES)
        check_choice("route", self.route, ROUTES)
        for name, least in _WHOLE.items():
            check_whole(name, getattr(self, name), least=least)
        if self.samples is not None:
            check_whole("samples", self.samples, least=1)
        if self.drive is not None:
            check_whole("drive", self.drive, least=0)
        for name in _PARTS:
            check_number(name, getattr(self, name), least=0.0)
        for name in _POSITIVE:
            check_number(name, getattr(self, name), above=0.0)
        self._check_view()

    def _check_view(self) -> None:
        check_number("field_of_view", self.field_of_view, below=180.0)
        check_number("laser_field_of_view", self.laser_field_of_view, most=360.0)
        for name in ("width", "height"):
            check_whole(name, getattr(self, name), least=1, most=_SIDE)
        if self.width * self.height > _PIXELS:
            raise UsageError(
                f"width x height is {self.width * self.height} pixels; give at most {_PIXELS}"
            )


def _pose(values: NDArray[np.float64], frame: str) -> Pose2D:
    x, y, theta = values.tolist()
    return Pose2D(x, y, theta, frame)
