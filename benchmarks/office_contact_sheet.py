"""Draw every room of the simulated benchmark in every condition, beside one another, into one PNG.

python benchmarks/office_contact_sheet.py docs/office_contact_sheet.png
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.observation import Image, Pose2D
from placecue_office.simulator import Office

CONDITIONS = [(run, light) for light in ("cloudy", "night", "sunny") for run in (1, 3)]
MOMENTS = (0.3, 0.6)
SIZE = (160, 120)


def labels(office: Office) -> NDArray[np.str_]:
    """Return the label of each moment of a drive."""
    return np.array([office.built.label_at(x, y) or "" for x, y, _ in office.true_poses.tolist()])


def frame(office: Office, index: int) -> Image:
    """Return an image of the sequence."""
    x, y, theta = office.true_poses[index].tolist()
    return office.render(Pose2D(x, y, theta, "map"), index)


def nearest(office: Office, room: str, x: float, y: float, theta: float) -> int:
    """Return the moment of a drive in a room at which the robot sees most nearly the same."""
    poses = office.true_poses
    turned = np.abs((poses[:, 2] - theta + np.pi) % (2 * np.pi) - np.pi)
    away = np.hypot(poses[:, 0] - x, poses[:, 1] - y) + 2 * turned
    return int(np.where(labels(office) == room, away, np.inf).argmin())


def tile(image: Image, text: str) -> NDArray[np.uint8]:
    """Shrink an image, write under it, and keep 32 levels a colour so that the PNG stays small."""
    small = cv2.resize(image, SIZE, interpolation=cv2.INTER_AREA) // 8 * 8 + 4
    captioned = cv2.copyMakeBorder(small, 0, 16, 0, 2, cv2.BORDER_CONSTANT, value=(255,) * 3)
    where = (3, SIZE[1] + 12)
    cv2.putText(captioned, text, where, cv2.FONT_HERSHEY_SIMPLEX, 0.36, (0,) * 3, 1, cv2.LINE_AA)
    return np.asarray(captioned, dtype=np.uint8)


def main(out: Path, world: str, seed: int) -> None:
    """Draw the sheet: two rows for each room, a column for each light, before and after."""
    offices = [
        Office(world=world, seed=seed, illumination=light, run=run) for run, light in CONDITIONS
    ]
    first, rooms = offices[0], labels(offices[0])
    rows = []
    for room in sorted(set(rooms.tolist())):
        moments = np.flatnonzero(rooms == room)
        for moment in MOMENTS:
            pose = first.true_poses[moments[int(moment * len(moments))]].tolist()
            tiles = [
                tile(
                    frame(office, nearest(office, room, *pose)),
                    f"{room}, {office.illumination} {office.run}",
                )
                for office in offices
            ]
            rows.append(np.hstack(tiles))
    cv2.imwrite(str(out), np.vstack(rows)[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--world", default="idol2_floor")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    main(given.out, given.world, given.seed)
