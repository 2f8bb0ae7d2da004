"""Small recordings in the layouts of public data sets, from poses, as folders and as tars."""

from __future__ import annotations

import csv
import gzip
import os
import tarfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest

DATA = os.environ.get("PLACECUE_DATA")
needs_data = pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")


@dataclass(frozen=True)
class Sample:
    """A recorded pose: time (s, with all digits), x, y (m), heading (rad), room."""

    stamp: str
    x: float
    y: float
    theta: float
    label: str

    @property
    def nanoseconds(self) -> int:
        seconds, fraction = self.stamp.split(".")
        return int(seconds) * 10**9 + int(fraction.ljust(9, "0"))


def drive(
    count: int = 12, labels: Sequence[str] = ("KT", "CR", "BO"), step: int = 200_000
) -> list[Sample]:
    """A hand-made drive: on a circle of 2 m around (3, -1), a third of it in each room.

    Samples are ``step`` microseconds apart.
    """
    samples = []
    for k in range(count):
        turn = 2 * np.pi * k / count
        seconds, micro = divmod(1138915484_100_000 + step * k, 10**6)
        x, y = 3 + 2 * np.cos(turn), -1 + 2 * np.sin(turn)
        heading = np.arctan2(np.cos(turn), -np.sin(turn))
        label = labels[k * len(labels) // count]
        samples.append(Sample(f"{seconds}.{micro:06d}", float(x), float(y), float(heading), label))
    return samples


def recorded(file: str, count: int, **wanted: str) -> list[Sample]:
    """The first recorded samples of a sequence, from the shared annotations."""
    with gzip.open(Path(str(DATA)) / file, "rt") as lines:
        rows = (r for r in csv.DictReader(lines) if all(r[k] == v for k, v in wanted.items()))
        return [
            Sample(r["stamp"], float(r["x"]), float(r["y"]), float(r["theta"]), r["label"])
            for r, _ in zip(rows, range(count), strict=False)
        ]


def picture(shade: int, suffix: str = ".png") -> bytes:
    """A small picture whose mean tells which it is."""
    image = np.full((12, 16, 3), shade % 256, dtype=np.uint8)
    return cv2.imencode(suffix, image)[1].tobytes()


def idol2_name(sample: Sample) -> str:
    """As IDOL2 names images: the time with six decimals, the rest as C's %g."""
    return f"t{sample.stamp}_r{sample.label}_x{sample.x:g}_y{sample.y:g}_a{sample.theta:g}.png"


def cold_name(sample: Sample) -> str:
    return f"t{sample.stamp}_x{sample.x:.6f}_y{sample.y:.6f}_a{sample.theta:.6f}.jpeg"


def scan_line(stamp: str, ranges: Sequence[float], step: float = 0.00872665) -> str:
    """A record of a CURE scan file, as IDOL2 has them."""
    seconds, micro = stamp.split(".")
    n = len(ranges)
    head = f"2 0 {n} {seconds} {int(micro)} 4 4 {n + 4} 0 0 2 0 {step} 0 32 0.001"
    return f"{head} {' '.join(f'{r:g}' for r in ranges)}"


def odometry_line(stamp: str, x: float, y: float, theta: float, fields: int = 14) -> str:
    seconds, micro = stamp.split(".")
    tail = f"{x:g} {y:g} 0 {theta:g} 0 0" if fields == 14 else f"{x:g} {y:g} {theta:g} 0 0"
    return f"1 0 6 {seconds} {int(micro)} 4 4 10 {tail}"


def ramp(number: int, beams: int) -> list[float]:
    """Ranges that tell beam and scan: 1 m on the right, growing to the left."""
    return [round(1 + 0.01 * beam + 0.1 * (number % 7), 3) for beam in range(beams)]


def write(path: Path, content: str | bytes) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def idol2_folder(
    root: Path, samples: Sequence[Sample], name: str = "dum_cloudy1", beams: int = 361
) -> Path:
    """A sequence of IDOL2; without scans where there are no beams."""
    folder = root / name
    for number, sample in enumerate(samples):
        write(folder / "png" / idol2_name(sample), picture(number))
    if beams:
        lines = (scan_line(s.stamp, ramp(k, beams)) for k, s in enumerate(samples))
        write(folder / "scans.tdf", "\n".join(lines) + "\n")
        odometry = (odometry_line(s.stamp, s.x + 5, s.y, s.theta) for s in samples)
        write(folder / "odom.tdf", "\n".join(odometry) + "\n")
    return folder


def cold_folder(root: Path, samples: Sequence[Sample], name: str = "seq1_cloudy2") -> Path:
    """A sequence of COLD, with another camera beside."""
    folder = root / "freiburg" / "part_a" / name
    for number, sample in enumerate(samples):
        write(folder / "std_cam" / cold_name(sample), picture(number, ".jpg"))
        write(folder / "omni_cam" / cold_name(sample), picture(255, ".jpg"))
    places = "".join(f"{cold_name(s)} {s.label}\n" for s in samples)
    write(folder / "localization" / "places.lst", places)
    step = 0.0174533
    lines = (scan_line(s.stamp, ramp(k, 181), step) for k, s in enumerate(samples))
    write(folder / "odom_scans" / "scans.tdf", "\n".join(lines) + "\n")
    odometry = (odometry_line(s.stamp, s.x, s.y, s.theta, 13) for s in samples)
    write(folder / "odom_scans" / "odom.tdf", "\n".join(odometry) + "\n")
    return folder


def packed(folder: Path, to: Path, mode: str = "w", shuffled: bool = False) -> Path:
    """The folder as a tar, named as its entries are; members in a wild order if wanted."""
    with tarfile.open(to, mode) as tar:
        if not shuffled:
            tar.add(folder, arcname=folder.name)
            return to
        files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
        for index in np.random.default_rng(0).permutation(len(files)):
            tar.add(files[index], arcname=f"./{files[index].relative_to(folder.parent)}")
    return to


def same(first: Iterable, second: Iterable) -> None:
    """Assert that two sources give the same."""
    for one, other in zip(first, second, strict=True):
        assert (one.stamp, one.label, one.pose) == (other.stamp, other.label, other.pose)
        assert getattr(one.image_source, "data", None) == getattr(other.image_source, "data", None)
        assert (one.scan is None) == (other.scan is None)
        if one.scan is not None:
            np.testing.assert_array_equal(one.scan.ranges, other.scan.ranges)
            np.testing.assert_array_equal(one.scan.angles, other.scan.angles)
