"""What benchmarks/slam.py makes of its runs: evo's errors, pictures, and the tables."""

from __future__ import annotations

import json
from collections import defaultdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from evo.core import metrics, sync
from evo.core.trajectory import PoseTrajectory3D
from evo.tools import file_interface
from slam_drives import Drive, Found, Poses

from placecue import Observation, Pose2D
from placecue.slam.planar import array_of, between, compose, moved
from placecue.slam.trajectory import tum
from placecue_accumulators.door import Door

mpl.use("agg")
import matplotlib.pyplot as plt

#: Passages no farther apart than this, m, are of one door.
ONE_DOOR = 0.6
#: Ends of beams farther than this, m, are not drawn; one scan in so many metres is.
DRAWN, EVERY = 12.0, 0.4
#: Cells of this side, m, are counted that were hit no farther away than this, m.
FINE, HIT = 0.05, 10.0


def trajectory(stamps: np.ndarray, poses: Poses) -> PoseTrajectory3D:
    """Return a trajectory as evo has it."""
    half, zeros = poses[:, 2] / 2, np.zeros(len(poses))
    return PoseTrajectory3D(
        positions_xyz=np.column_stack([poses[:, :2], zeros]),
        orientations_quat_wxyz=np.column_stack([np.cos(half), zeros, zeros, np.sin(half)]),
        timestamps=stamps / 1e9,
    )


def ape(stamps: np.ndarray, poses: Poses, reference: Poses) -> dict[str, float]:
    """Return evo's absolute pose error of the positions after alignment, m."""
    one, other = sync.associate_trajectories(
        trajectory(stamps, reference), trajectory(stamps, poses), max_diff=1e-3
    )
    other.align(one)
    error = metrics.APE(metrics.PoseRelation.translation_part)
    error.process_data((one, other))
    kinds = metrics.StatisticsType
    told = {"rms": kinds.rmse, "max": kinds.max}
    return {name: round(float(error.get_statistic(kind)), 3) for name, kind in told.items()}


def off_where_first_fits(poses: Poses, reference: Poses, count: int) -> np.ndarray:
    """Return how far poses are off, m, where the first ones are laid on the reference."""
    one, other = poses[:, :2], reference[:, :2]
    middles = one[:count].mean(axis=0), other[:count].mean(axis=0)
    u, _, v = np.linalg.svd((one[:count] - middles[0]).T @ (other[:count] - middles[1]))
    turn = u @ np.diag([1.0, np.linalg.det(u @ v)]) @ v
    return np.hypot(*((one - middles[0]) @ turn + middles[1] - other).T)


def doors_apart(drive: Drive, poses: Poses) -> float | None:
    """Return the largest distance between where a door lies by two passages, m."""
    assert drive.true is not None
    door, passages = Door(), []
    inside = False
    for number, each in enumerate(drive.observations):
        pose = Pose2D(*drive.true[number].tolist(), "map")
        crossed = door.update(Observation(each.stamp, scan=each.scan, pose=pose))
        if crossed is not None and not inside:
            there = array_of(crossed)
            seen = compose(poses[number], between(drive.true[number], there))
            passages.append((there[:2], seen[:2]))
        inside = crossed is not None or door.door_ is not None
    groups: list[list[tuple[np.ndarray, np.ndarray]]] = []
    for passage in passages:
        for group in groups:
            if np.hypot(*(group[0][0] - passage[0])) <= ONE_DOOR:
                group.append(passage)
                break
        else:
            groups.append([passage])
    # What the passages' own detections differ by is no error of the poses.
    off = [seen - there for group in groups for there, seen in group]
    starts = np.cumsum([0, *map(len, groups)])
    apart = [
        float(np.hypot(*(off[i] - off[j])))
        for a, b in pairwise(starts)
        for i in range(a, b)
        for j in range(i + 1, b)
    ]
    return round(max(apart), 3) if apart else None


def draw(drive: Drive, found: Found, out: Path) -> None:
    """Draw the walls by odometry and by corrected poses, and write the trajectories."""
    out.mkdir(parents=True, exist_ok=True)
    sets = [("odometry", drive.raw), ("corrected by scans", found.final)]
    sets += [] if drive.true is None else [("reference", drive.true)]
    figure, axes = plt.subplots(1, len(sets), figsize=(4.5 * len(sets), 4.5))
    for axis, (name, poses) in zip(np.atleast_1d(axes), sets, strict=True):
        points = _ends(drive, poses)
        axis.plot(*points.T, ",", color="#333333", alpha=0.4)
        axis.plot(*poses[:, :2].T, "-", color="#c0392b", linewidth=0.6)
        axis.set(title=name, aspect="equal")
        axis.tick_params(labelsize=7)
        word, known = name.split()[0], np.isfinite(poses[:, 0])
        (out / f"{word}.tum").write_text(tum(drive.stamps[known], poses[known]))
        file_interface.read_tum_trajectory_file(out / f"{word}.tum")
    figure.tight_layout()
    figure.savefig(out / "walls.png", dpi=110)
    plt.close(figure)


def _ends(drive: Drive, poses: Poses) -> np.ndarray:
    last, found = None, [np.empty((0, 2))]
    for each, pose in zip(drive.observations, poses, strict=True):
        if np.isnan(pose).any() or (last is not None and np.hypot(*(pose - last)[:2]) < EVERY):
            continue
        last = pose
        points = each.scan.points()
        found.append(moved(points[np.hypot(*points.T) <= DRAWN], pose))
    return np.vstack(found)


def tables(folder: Path) -> str:
    """Return the tables of what has been run so far, as Markdown."""
    parts: defaultdict[str, list[dict[str, Any]]] = defaultdict(list)
    for path in sorted(folder.glob("*.json")):
        result = json.loads(path.read_text())
        parts[result["part"]].append(result)
    made = {
        **{"office": _office, "carried": _carried, "carmen": _carmen, "bags": _bags},
        **{"explore": _explore, "speed": _speed},
    }
    return "\n\n".join(make(parts[part]) for part, make in made.items() if parts[part])


def _office(results: list[dict[str, Any]]) -> str:
    lines = [
        "| floor | drift | drives | odometry, rms (worst) | as told at once | at the end, rms "
        "(worst) | largest error | doors passed again, apart at most |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for floor, drift in sorted({(each["floor"], each["drift"]) for each in results}):
        some = [each for each in results if (each["floor"], each["drift"]) == (floor, drift)]
        raw, told, end = (
            [each[name]["rms"] for each in some] for name in ("odometry", "told", "slam")
        )
        doors = [each["doors_apart"] for each in some if each["doors_apart"] is not None]
        lines.append(
            f"| {floor} | {100 * drift:.0f} % | {len(some)} | {np.mean(raw):.2f} ({max(raw):.2f}) "
            f"| {np.mean(told):.2f} ({max(told):.2f}) | {np.mean(end):.3f} ({max(end):.3f}) "
            f"| {max(each['slam']['max'] for each in some):.2f} "
            f"| {max(doors, default=float('nan')):.2f} |"
        )
    return "\n".join(lines)


def _carried(results: list[dict[str, Any]]) -> str:
    lines = [
        "| floor | run | scans before it was carried, and after | off then, m, median: loops by "
        "position alone | by likeness too | knew where it was after |",
        "|---|---|---|---|---|---|",
    ]
    for each in results:
        alone, also = each["position"], each["likeness"]
        lines.append(
            f"| {each['floor']} | {each['seed']} | {each['scans'] - also['of']}, {also['of']} "
            f"| {alone['off']:.2f} | {also['off']:.2f} "
            f"| {'never' if also['knew'] == also['of'] else str(also['knew']) + ' scans'} |"
        )
    return "\n".join(lines)


def _carmen(results: list[dict[str, Any]]) -> str:
    lines = [
        "| log | scans | way, m | odometry, rms | as told at once | at the end, rms | largest "
        "error | loops (refused) |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for each in results:
        account = each["account"]
        lines.append(
            f"| {each['name'].removeprefix('carmen-')} | {each['scans']} | {each['way']:.0f} "
            f"| {each['odometry']['rms']:.2f} | {each['told']['rms']:.2f} "
            f"| {each['slam']['rms']:.3f} | {each['slam']['max']:.2f} "
            f"| {account['loops']} ({account['refused']}) |"
        )
    return "\n".join(lines)


def cells_hit(drive: Drive, poses: Poses) -> int:
    """Return how many cells of 5 cm the laser hit within 10 m: fewer where walls are thin."""
    keys: set[tuple[int, int]] = set()
    for each, pose in zip(drive.observations, poses, strict=True):
        if np.isnan(pose).any():
            continue
        points = each.scan.points()
        placed = moved(points[np.hypot(*points.T) <= HIT], pose)
        keys.update(map(tuple, np.unique(np.floor(placed / FINE).astype(int), axis=0).tolist()))
    return len(keys)


def _bags(results: list[dict[str, Any]]) -> str:
    lines = [
        "| log | scans | way, m | seen again | of it where it was, by odometry | corrected "
        "| cells of 5 cm hit, by odometry | corrected |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for each in results:
        raw, slam = each["odometry"], each["slam"]
        lines.append(
            f"| {each['name'].removeprefix('bag-')} | {each['scans']} | {each['way']:.0f} "
            f"| {slam['again']} | {raw['share']:.3f} | {slam['share']:.3f} "
            f"| {raw['cells']} | {slam['cells']} |"
        )
    return "\n".join(lines)


def _explore(results: list[dict[str, Any]]) -> str:
    lines = [
        "| run | areas by true poses | labelled alike by odometry (areas) | corrected (areas) |",
        "|---|---|---|---|",
    ]
    for each in results:
        raw, slam = each["odometry"], each["slam"]
        lines.append(
            f"| {each['seed']} | {each['areas']} | {raw['alike']} ({raw['areas']}) "
            f"| {slam['alike']} ({slam['areas']}) |"
        )
    return "\n".join(lines)


def _speed(results: list[dict[str, Any]]) -> str:
    return "\n".join(
        f"{each['scans']} scans ({each['hours']:.2f} h, {each['way']:.0f} m): "
        f"{each['per_second']:.0f} scans a second of processor time; latency median "
        f"{each['median_ms']:.1f} ms, 99th percentile {each['late_ms']:.1f} ms, largest "
        f"{each['worst_ms']:.0f} ms; {each['keyframes']} keyframes; on new ground "
        f"{each['bytes']:.0f} bytes an observation, {each['keyframe_bytes']:.0f} a keyframe; "
        f"off there at the end: {each['new_off']:.2f} m; memory by scans: "
        + ", ".join(f"{n}: {b / 1e6:.1f} MB ({k})" for n, b, k in each["grown"])
        for each in results
    )
