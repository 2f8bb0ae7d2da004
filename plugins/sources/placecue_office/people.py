"""People: some sit on chairs, some walk from room to room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from placecue_office.blocks import Block
from placecue_office.floor import Floor
from placecue_office.plan import Furniture, Plan, Points, turned
from placecue_office.route import Planner

#: Who is not there stands here, m.
AWAY = (-1e4, -1e4, 0.0)

#: First keys of the pictures on people, of whom there are none.
_KEYS = 40_000

_CLOTHES = ("#27344e", "#5a2d2d", "#3d4a38", "#1f1f24", "#b8b4a8", "#7a6a52", "#44607a", "#8a3c4c")
_SKIN = ("#d8ab8c", "#b98763", "#8a5a3c", "#e2bca2")


def standing(rng: np.random.Generator, swing: float = 0.0) -> list[Block]:
    """Return a person at the origin who looks along x: two legs, a body, a head.

    Parameters
    ----------
    rng : Generator
        Draws the clothes.
    swing : float
        How far the left leg is ahead of the right one, m.
    """
    trousers, shirt, skin = _dress(rng)
    return [
        _part((0.5 * swing, 0.11), (0.16, 0.14), (0.0, 0.85), trousers),
        _part((-0.5 * swing, -0.11), (0.16, 0.14), (0.0, 0.85), trousers),
        _part((0.0, 0.0), (0.24, 0.44), (0.85, 1.47), shirt),
        _part((0.03, 0.0), (0.2, 0.17), (1.5, 1.75), skin),
    ]


def seated(chair: Furniture, rng: np.random.Generator) -> list[Block]:
    """Return a person on a chair, whose front is the first edge of its outline."""
    trousers, shirt, skin = _dress(rng)
    body = [
        _part((0.3, 0.11), (0.14, 0.14), (0.0, 0.5), trousers),
        _part((0.3, -0.11), (0.14, 0.14), (0.0, 0.5), trousers),
        _part((0.15, 0.0), (0.42, 0.36), (0.5, 0.63), trousers),
        _part((-0.05, 0.0), (0.22, 0.42), (0.63, 1.1), shirt),
        _part((-0.03, 0.0), (0.2, 0.17), (1.13, 1.36), skin),
    ]
    centre = chair.outline.mean(axis=0)
    ahead = chair.outline[:2].mean(axis=0) - centre
    place = (float(centre[0]), float(centre[1]), float(np.arctan2(ahead[1], ahead[0])))
    return [at_place(block, place) for block in body]


def sit_down(
    furniture: Sequence[Furniture], floor: Floor, share: float, rng: np.random.Generator
) -> list[Block]:
    """Return the people on a part of the chairs, none of them where the way is."""
    blocks: list[Block] = []
    for chair in furniture:
        chance, dress = rng.random(), rng.integers(2**31)
        if chair.type == "chair" and chance < share:
            person = seated(chair, np.random.default_rng(dress))
            if not any(floor.in_the_way(block.outline) for block in person):
                blocks += person
    return blocks


def at_place(block: Block, place: tuple[float, float, float]) -> Block:
    """Return a block moved from the origin to x, y (m) and heading (rad)."""
    return replace(block, outline=turned(block.outline, place[2]) + place[:2])


def _dress(rng: np.random.Generator) -> tuple[str, str, str]:
    trousers, shirt = rng.choice(_CLOTHES, 2)
    return f"fabric {trousers}", f"fabric {shirt}", f"plain {rng.choice(_SKIN)}"


def _part(
    centre: tuple[float, float], size: tuple[float, float], heights: tuple[float, float], look: str
) -> Block:
    """Return an eight-sided prism."""
    angles = np.linspace(0, 2 * np.pi, 8, endpoint=False) + np.pi / 8
    outline = np.array(centre) + 0.54 * np.array(size) * np.column_stack(
        [np.cos(angles), np.sin(angles)]
    )
    return Block(outline, *heights, (look,) * 8, look, solid=False, key=_KEYS)


@dataclass(frozen=True, slots=True)
class Walk:
    """One way that a person walks.

    Parameters
    ----------
    start : float
        When, s after the drive began.
    path : ndarray, shape (n, 2)
        Points 5 cm apart, m.
    speed : float
        m/s.
    """

    start: float
    path: Points
    speed: float

    @property
    def end(self) -> float:
        """When the person has arrived, s."""
        return self.start + 0.05 * (len(self.path) - 1) / self.speed

    def at(self, time: float) -> tuple[float, float, float]:
        """Return x, y and heading of the person, far away before and after the walk."""
        along = (time - self.start) * self.speed / 0.05
        if not 0 <= along < len(self.path) - 1:
            return AWAY
        whole = int(along)
        before, after = self.path[max(whole - 4, 0)], self.path[min(whole + 4, len(self.path) - 1)]
        x, y = self.path[whole] + (along - whole) * (self.path[whole + 1] - self.path[whole])
        return float(x), float(y), float(np.arctan2(*(after - before)[::-1]))


@dataclass(frozen=True, slots=True)
class Walkers:
    """How people walk about.

    Parameters
    ----------
    radius : float
        Room that a person needs, m.
    apart : float
        Least distance from the robot's middle, m.
    sight : float
        Nearer than this nobody appears or vanishes in the robot's room, m.
    pause : (float, float)
        Shortest and longest time between two walks of one person, s.
    tries : int
        Walks thought of before a person waits for another pause.
    """

    radius: float = 0.24
    apart: float = 0.7
    sight: float = 7.0
    pause: tuple[float, float] = (5.0, 40.0)
    tries: int = 6

    def walks(
        self,
        plan: Plan,
        planner: Planner,
        times: NDArray[np.float64],
        drive: NDArray[np.float64],
        rng: np.random.Generator,
    ) -> list[Walk]:
        """Return the walks of one person during a drive, in order.

        Parameters
        ----------
        plan : Plan
            The building, for its rooms.
        planner : Planner
            Finds ways for somebody of this radius.
        times : ndarray, shape (n,)
            When the robot is where, s.
        drive : ndarray, shape (n, 3)
            Its poses.
        rng : Generator
            Chooses when and where people go.
        """
        walks: list[Walk] = []
        time = float(rng.uniform(0, self.pause[1]))
        rooms = plan.room_at(drive[:, :2])
        while time < times[-1]:
            for _ in range(self.tries):
                walk = self._thought_of(planner, time, rng)
                if walk is not None and self._passes(plan, walk, times, drive, rooms):
                    walks.append(walk)
                    time = walk.end
                    break
            time += float(rng.uniform(*self.pause))
        return walks

    def _thought_of(self, planner: Planner, time: float, rng: np.random.Generator) -> Walk | None:
        ends = rng.choice(planner.reachable, 2)
        speed = float(rng.uniform(0.8, 1.4))
        path = planner.path(ends) if ends[0] != ends[1] else np.empty((0, 2))
        return Walk(time, path, speed) if len(path) > 40 else None

    def _passes(
        self,
        plan: Plan,
        walk: Walk,
        times: NDArray[np.float64],
        drive: NDArray[np.float64],
        rooms: NDArray[np.int64],
    ) -> bool:
        """Tell whether a walk keeps away from the robot and begins and ends out of its sight."""
        moments = np.arange(walk.start, walk.end, 0.1)
        places = np.array([walk.at(moment)[:2] for moment in moments])
        rows = np.clip(np.searchsorted(times, moments), 0, len(times) - 1)
        away = np.linalg.norm(places - drive[rows, :2], axis=1)
        seen = [
            away[end] < self.sight and plan.room_at(places[[end]])[0] == rooms[rows[end]]
            for end in (0, -1)
        ]
        return bool(away.min() > self.apart) and not any(seen)
