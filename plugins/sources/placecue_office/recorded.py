"""The drives recorded in IDOL2: poses of the robot, by sequence."""

from __future__ import annotations

import csv
import gzip
import os
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, UsageError, choices
from placecue_office.plan import Points

#: Sequences are named after the robot.
ROBOT = "dum"


class Drive(NamedTuple):
    """Where a robot was when.

    Attributes
    ----------
    stamps : ndarray of float64, shape (n,)
        s.
    poses : ndarray of float64, shape (n, 3)
        x, y in m and heading in rad, unwrapped.
    labels : tuple of str
        What the data set calls each place; empty where nobody said.
    """

    stamps: NDArray[np.float64]
    poses: NDArray[np.float64]
    labels: tuple[str, ...] = ()


def find_poses(path: str | None) -> Path:
    """Return the file of the recorded poses.

    Raises
    ------
    UsageError
        If it is not given, and the environment variable ``PLACECUE_DATA`` is not set.
    """
    if path is not None:
        return Path(path)
    folder = os.environ.get("PLACECUE_DATA")
    if not folder:
        raise UsageError(
            "route=idol2 needs the recorded poses: set poses= to a poses.csv.gz with the columns "
            "sequence, stamp, x, y, theta, label, or PLACECUE_DATA to the folder that holds idol2/"
        )
    return Path(folder) / "idol2" / "poses.csv.gz"


@lru_cache(maxsize=2)
def read_drives(path: Path) -> Mapping[str, Drive]:
    """Read all drives of a CSV, plain or gzip, by the names of their sequences.

    Raises
    ------
    DataError
        If the file cannot be read or lacks a column.
    """
    columns: dict[str, list[tuple[float, float, float, float, str]]] = {}
    opened = gzip.open if path.suffix == ".gz" else open
    try:
        with opened(path, "rt", encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                stamp, x, y, theta = (float(row[name]) for name in ("stamp", "x", "y", "theta"))
                columns.setdefault(row["sequence"], []).append((stamp, x, y, theta, row["label"]))
    except (OSError, EOFError, ValueError, KeyError, TypeError) as error:
        raise DataError(f"{path} is no CSV of recorded poses: {error!r}") from error
    return {name: _drive(rows) for name, rows in columns.items()}


def _drive(rows: list[tuple[float, float, float, float, str]]) -> Drive:
    values = np.array([row[:4] for row in rows])
    heading = np.unwrap(values[:, 3])
    labels = tuple(row[4] for row in rows)
    return Drive(values[:, 0], np.column_stack([values[:, 1:3], heading]), labels)


def recorded_drive(path: Path, illumination: str, run: int) -> Drive:
    """Return the drive of one sequence.

    Raises
    ------
    DataError
        If there is none of that illumination and run.
    """
    drives, wanted = read_drives(path), f"{ROBOT}_{illumination}{run}"
    if wanted not in drives:
        raise DataError(f"{path} has no sequence '{wanted}': {choices(wanted, drives)}")
    return drives[wanted]


def all_positions(path: Path) -> Points:
    """Return where the robot was in any drive, m, shape (n, 2)."""
    return np.vstack([drive.poses[:, :2] for drive in read_drives(path).values()])
