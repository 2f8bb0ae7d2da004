"""Draw every room of the office simulator in every light, beside one another, into one PNG.

python benchmarks/office_contact_sheet.py docs/office_contact_sheet.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from placecue.observation import Image, Pose2D
from placecue_sources.office import Office

LIGHTS = ("cloudy", "night", "sunny")
MOMENTS = (0.3, 0.6)
SIZE = (176, 132)


def views(office: Office) -> dict[str, list[Pose2D]]:
    """Return poses of a drive by room, at fixed parts of the time spent there."""
    poses = [Pose2D(x, y, theta, "map") for x, y, theta in office.true_poses.tolist()]
    labels = np.array([office.built.label_at(pose.x, pose.y) for pose in poses])
    chosen = {}
    for label in sorted(set(labels.tolist())):
        rows = np.flatnonzero(labels == label)
        chosen[label] = [poses[rows[int(moment * len(rows))]] for moment in MOMENTS]
    return chosen


def tile(image: Image, text: str) -> NDArray[np.uint8]:
    """Shrink an image, write under it, and keep 32 levels a colour so that the PNG stays small."""
    small = cv2.resize(image, SIZE, interpolation=cv2.INTER_AREA) // 8 * 8 + 4
    captioned = cv2.copyMakeBorder(small, 0, 16, 0, 2, cv2.BORDER_CONSTANT, value=(255,) * 3)
    where = (3, SIZE[1] + 12)
    cv2.putText(captioned, text, where, cv2.FONT_HERSHEY_SIMPLEX, 0.38, (0,) * 3, 1, cv2.LINE_AA)
    return np.asarray(captioned, dtype=np.uint8)


def main(out: Path) -> None:
    """Draw the sheet: a row for each room, a column for each view in each light."""
    offices = [Office(illumination=light, run=1) for light in LIGHTS]
    rows = [
        np.hstack(
            [
                tile(office.render(pose), f"{label}, {office.illumination}")
                for pose in poses
                for office in offices
            ]
        )
        for label, poses in views(offices[0]).items()
    ]
    cv2.imwrite(str(out), np.vstack(rows)[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/office_contact_sheet.png"))
