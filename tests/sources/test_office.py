from __future__ import annotations

import csv
import hashlib
import os
import pickle
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from placecue.errors import UsageError
from placecue.observation import Observation
from placecue_office.drive import follow, odometry
from placecue_office.raster import Raster
from placecue_office.simulator import Office
from placecue_sources.raycast import OccupancyGrid, cast_rays

DATA = os.environ.get("PLACECUE_DATA")
ROOMS = {"corridor", "kitchen", "one_person_office", "printer_area", "two_person_office"}


@pytest.fixture(scope="module")
def office() -> Office:
    return Office(image_noise=3.0)


@pytest.fixture(scope="module")
def drive(office: Office) -> list[Observation]:
    return list(office)


def distances(points: NDArray[np.float64], faces: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance of each point (n, 2) to the nearest segment of (k, 4)."""
    a, b = faces[None, :, :2], faces[None, :, 2:]
    along = b - a
    part = ((points[:, None] - a) * along).sum(-1) / (along**2).sum(-1)
    nearest = a + np.clip(part, 0, 1)[..., None] * along
    return np.asarray(np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1))


def picture_hash(source: Office, rows: list[int]) -> str:
    observations = list(source)
    return hashlib.sha256(
        b"".join(observations[row].image.tobytes() for row in rows)  # type: ignore[union-attr]
    ).hexdigest()


# what a drive is


def test_every_room_is_seen_and_the_corridor_most_often(drive: list[Observation]) -> None:
    counts = Counter(observation.label for observation in drive)
    assert set(counts) == ROOMS
    assert 350 < len(drive) < 600
    for room in ROOMS - {"corridor"}:
        assert counts[room] >= 30
        assert 2 <= counts["corridor"] / counts[room] <= 6


def test_stamps_and_count(office: Office, drive: list[Observation]) -> None:
    assert office.count() == len(drive)
    assert set(np.diff([observation.stamp for observation in drive])) == {200_000_000}
    assert office.metadata == {
        "dataset": "office",
        "world": "idol2_floor",
        "version": "3",
        "seed": "0",
        "illumination": "cloudy",
        "run": "1",
        "half_years": "0",
        "route": "planned",
    }


def test_samples_cut_the_same_drive(drive: list[Observation]) -> None:
    few = list(Office(samples=5))
    assert [each.stamp for each in few] == [each.stamp for each in drive[:5]]
    assert [each.pose for each in few] == [each.pose for each in drive[:5]]
    np.testing.assert_array_equal(few[4].scan.ranges, drive[4].scan.ranges)  # type: ignore[union-attr]


@pytest.mark.parametrize("run", [1, 2, 3, 4])
@pytest.mark.parametrize(("seed", "speed"), [(0, 1.0), (0, 0.4), (7, 1.5)])
def test_the_robot_touches_nothing(seed: int, run: int, speed: float) -> None:
    office = Office(seed=seed, run=run, speed=speed)
    solid = np.array(
        [
            office.built.geometry.faces[face]
            for number, block in enumerate(office.built.blocks)
            if block.solid and block.bottom < 1.2
            for face in range(*office.built.geometry.starts[number : number + 2])
        ]
    )
    away = distances(office.true_poses[:, :2], solid)
    assert away.min() > office.robot_radius


def test_the_robot_moves_as_fast_as_it_may_and_no_faster(office: Office) -> None:
    moves = np.diff(office.true_poses, axis=0)
    assert np.linalg.norm(moves[:, :2], axis=1).max() <= office.speed / office.rate + 1e-9
    assert np.abs(moves[:, 2]).max() <= office.turn_rate / office.rate + 1e-9


def test_runs_differ_in_the_way_taken_and_worlds_in_their_looks() -> None:
    one, two = (Office(run=run).true_poses for run in (1, 2))
    count = min(len(one), len(two))
    assert np.linalg.norm(one[:count, :2] - two[:count, :2], axis=1).max() > 0.2
    first, second = (next(iter(Office(seed=seed))).image for seed in (0, 1))
    assert not np.array_equal(first, second)


# determinism


def test_the_same_parameters_give_the_same_bytes(drive: list[Observation]) -> None:
    again = list(Office(image_noise=3.0))
    for row in (300, 5, 150):  # in another order than they come
        np.testing.assert_array_equal(again[row].image, drive[row].image)
        np.testing.assert_array_equal(again[row].scan.ranges, drive[row].scan.ranges)  # type: ignore[union-attr]
    assert again[-1].pose == drive[-1].pose


def test_another_process_gives_the_same_bytes() -> None:
    script = (
        "import sys; sys.path.insert(0, sys.argv[1]); from test_office import *; "
        "print(picture_hash(Office(samples=9), [2, 8]))"
    )
    command = [sys.executable, "-c", script, str(Path(__file__).parent)]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    assert told == picture_hash(Office(samples=9), [2, 8])


def test_digest_tells_parameters_apart() -> None:
    assert Office().digest() == Office().digest()
    changed = [Office(run=2), Office(illumination="night"), Office(image_noise=2.0), Office(seed=1)]
    assert len({source.digest() for source in [Office(), *changed]}) == 5


def test_a_pending_image_survives_pickling(drive: list[Observation]) -> None:
    sent = pickle.loads(pickle.dumps(drive[7].image_source))
    np.testing.assert_array_equal(sent(), drive[7].image)


# image


def test_a_laser_only_reader_renders_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    render = Office.render

    def counted(self: Office, *given: object) -> object:
        calls.append(given)
        return render(self, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(Office, "render", counted)
    office = Office(samples=20)
    observations = list(office)
    assert all(observation.scan is not None for observation in observations)
    assert not calls
    assert "skin" not in vars(office.built)  # not even a texture was drawn
    assert observations[3].image is observations[3].image
    assert len(calls) == 1


def test_images_are_of_the_asked_size_and_well_exposed(drive: list[Observation]) -> None:
    for observation in drive[::40]:
        image = observation.image
        assert image is not None
        assert image.shape == (240, 320, 3)
        assert image.dtype == np.uint8
        assert 60 < image.mean() < 180
        assert image.std() > 10
    small = next(iter(Office(width=64, height=48))).image
    assert small is not None
    assert small.shape == (48, 64, 3)


def colours(source: Office) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """Return 6 x 6 x 6 colour histograms of every eighth image, and the labels."""
    chosen = list(source)[::8]
    bins = [
        np.asarray(each.image, dtype=int).reshape(-1, 3) * 6 // 256 @ [36, 6, 1] for each in chosen
    ]
    histograms = [np.bincount(each, minlength=216) / each.size for each in bins]
    return np.array(histograms), np.array([each.label for each in chosen])


def test_rooms_look_different_and_alike_from_run_to_run() -> None:
    trained, labels = colours(Office(run=1, width=80, height=60))
    tested, truth = colours(Office(run=2, width=80, height=60))
    nearest = np.abs(tested[:, None] - trained[None]).sum(axis=2).argmin(axis=1)
    recalls = [(labels[nearest] == truth)[truth == room].mean() for room in sorted(ROOMS)]
    assert np.mean(recalls) > 0.6, recalls  # a guess gets 0.2


def test_the_light_changes_the_image_and_nothing_else(drive: list[Observation]) -> None:
    cloudy, night = (
        list(Office(illumination=light, drive=10, samples=11)) for light in ("cloudy", "night")
    )
    assert cloudy[10].pose == drive[10].pose  # the number of the first run's own
    assert night[10].pose == drive[10].pose
    np.testing.assert_array_equal(night[10].scan.ranges, drive[10].scan.ranges)  # type: ignore[union-attr]
    by_day, by_night = (np.asarray(each[10].image, dtype=float) for each in (drive, night))
    warmth = [(image[..., 0] / (image[..., 2] + 1)).mean() for image in (by_day, by_night)]
    assert warmth[1] > warmth[0]


# laser


def test_end_points_lie_on_the_plan(office: Office, drive: list[Observation]) -> None:
    for row in range(0, len(drive), 60):
        faces = office.geometry(row).cut(0.3)
        scan, (x, y, theta) = drive[row].scan, office.true_poses[row]
        assert scan is not None
        valid = scan.valid()
        bearings = scan.angles[valid] + theta
        ends = np.array([x, y]) + scan.ranges[valid, None] * np.column_stack(
            [np.cos(bearings), np.sin(bearings)]
        )
        assert distances(ends, faces).max() < 6 * office.range_noise


def test_beams_agree_with_a_caster_in_a_grid(office: Office) -> None:
    exact = list(Office(range_noise=0.0, samples=200, walkers=0))
    raster = Raster.over(office.built.plan, 0.02)
    blocks = [block for block in office.built.blocks if block.closed]
    solid = raster.fill(block.outline for block in blocks if block.bottom <= 0.3 < block.top)
    grid = OccupancyGrid(solid, raster.cell, (float(raster.origin[0]), float(raster.origin[1])))
    for row in range(0, 200, 20):
        scan, (x, y, theta) = exact[row].scan, office.true_poses[row]
        assert scan is not None
        lengths = cast_rays(grid, x, y, scan.angles + theta, scan.range_max)
        off = np.abs(lengths - scan.ranges)  # long where a beam just meets, or misses, a leg
        assert np.median(off) < 0.03
        assert np.mean(off < 0.06) > 0.85


def test_one_measures_through_an_open_door_and_not_through_the_wall(office: Office) -> None:
    faces = Office(clutter=0, seated=0.0).built.geometry.cut(0.3)
    middle = np.array([6.2, 16.45])
    through, beside = (
        cast_from(faces, middle, np.array(target)) for target in ([4.0, 16.45], [4.0, 17.9])
    )
    assert through == pytest.approx(6.2 - 3.33)  # the screen between the two desks
    assert beside == pytest.approx(np.hypot(0.92, 0.92 * 1.45 / 2.2), abs=1e-6)


def cast_from(
    faces: NDArray[np.float64], start: NDArray[np.float64], target: NDArray[np.float64]
) -> float:
    from placecue_office.trace import cast

    x, y = target - start
    return float(cast(faces, start[0], start[1], np.array([np.arctan2(y, x)]))[0])


def test_posts_stand_beside_the_robot_in_a_doorway(
    office: Office, drive: list[Observation]
) -> None:
    widths = []
    for observation, (x, y, _) in zip(drive, office.true_poses, strict=True):
        if y > 8.65 and min(abs(x - 5.055), abs(x - 7.515)) < 0.1:
            assert observation.scan is not None
            right, left = observation.scan.ranges[:40].min(), observation.scan.ranges[-40:].min()
            widths.append(right + left)
    assert len(widths) >= 5  # three doors, passed both ways
    assert all(0.6 <= width <= 1.05 for width in widths)


@pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")
def test_real_scans_of_the_floor_meet_the_plan(office: Office) -> None:
    folder = Path(str(DATA)) / "idol2"
    with (folder / "scans_sample.csv").open() as file:
        poses = {row["scan_stamp"]: row for row in csv.DictReader(file) if row["x"]}
    faces = Office(clutter=0, seated=0.0).built.geometry.cut(0.3)
    shares = []
    for line in (folder / "scans_sample.tdf").read_text().splitlines():
        fields = line.split()
        pose = poses.get(f"{fields[3]}.{int(fields[4]):06d}")
        if pose is None:
            continue
        ranges = np.array(fields[16 : 16 + int(fields[2])], dtype=float)
        bearings = float(pose["theta"]) - np.pi / 2 + np.arange(len(ranges)) * float(fields[12])
        unit = np.column_stack([np.cos(bearings), np.sin(bearings)])
        ends = np.array([float(pose["x"]), float(pose["y"])]) + ranges[:, None] * unit
        shares.append(np.mean(distances(ends[ranges < 12], faces) < 0.15))
    assert len(shares) == 6
    assert np.median(shares) > 0.6, shares


# odometry


def test_odometry_without_drift_is_the_truth(office: Office) -> None:
    same = odometry(office.true_poses, 0.0, np.random.default_rng(0))
    np.testing.assert_allclose(same, office.true_poses, atol=1e-9)


def test_odometry_begins_at_the_truth_and_drifts_away(
    office: Office, drive: list[Observation]
) -> None:
    given = np.array([(each.pose.x, each.pose.y) for each in drive if each.pose is not None])
    off = np.linalg.norm(given - office.true_poses[:, :2], axis=1)
    assert off[0] == 0
    assert off[:20].max() < 0.1
    assert 0.05 < off.max() < 5
    assert {each.pose.frame for each in drive if each.pose is not None} == {"odom"}


def test_the_true_pose_can_be_had() -> None:
    office = Office(pose="truth", samples=3)
    pose = list(office)[2].pose
    assert pose is not None
    assert (pose.x, pose.y, pose.theta, pose.frame) == (*office.true_poses[2], "map")


def test_a_follower_gets_to_the_end_of_a_straight_path() -> None:
    path = np.column_stack([np.linspace(0, 5, 101), np.zeros(101)])
    states = follow(path, speed=0.5)
    assert states[-1, 0] == pytest.approx((5 - 0.25) / 0.5, abs=0.05)
    np.testing.assert_allclose(states[:, 2:], 0, atol=1e-9)


# sizes of the image


@pytest.mark.parametrize(
    ("width", "height"),
    [(96, 72), (97, 73), (1, 1), (2, 1), (1, 300), (3000, 1), (7, 5)],
)
def test_an_image_may_have_any_size(width: int, height: int) -> None:
    office = Office(width=width, height=height, samples=1, beams=1, image_noise=0.0)
    image = next(iter(office)).image
    assert image is not None
    assert image.shape == (height, width, 3)
    assert 20 < image.mean() < 235


def test_an_odd_image_is_the_middle_of_an_even_one_with_finer_rows() -> None:
    # 81 rows of the same view lie where every third of 243 does; the middle one is the horizon.
    fine = next(iter(Office(width=324, height=243, samples=1, image_noise=0.0, shutter=0.0)))
    coarse = next(iter(Office(width=108, height=81, samples=1, image_noise=0.0, shutter=0.0)))
    assert fine.image is not None
    assert coarse.image is not None
    difference = np.abs(fine.image[1::3, 1::3].astype(float) - coarse.image)
    assert np.median(difference) < 6
    assert difference[40].mean() < 2 * difference.mean()


# wrong requests


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"illumination": "cludy"}, "did you mean 'cloudy'"),
        ({"world": "idol_floor"}, "did you mean 'idol2_floor'"),
        ({"pose": "true"}, "truth"),
        ({"rate": 0}, "rate"),
        ({"samples": 0}, "samples"),
        ({"run": -1}, "run"),
        ({"width": 0}, "width is 0; give a whole number of at least 1"),
        ({"height": 65_501}, "height is 65501; give a whole number of at most 65500"),
        ({"width": 20_000, "height": 20_000}, "width x height is 400000000 pixels"),
        ({"field_of_view": 180}, "field_of_view is 180; give a number below 180"),
        ({"laser_field_of_view": 361.0}, "laser_field_of_view is 361.0; give a number of at most"),
        ({"camera_height": 30.0}, "camera_height is 30.0; give a number below"),
    ],
)
def test_wrong_requests_are_told_in_one_line(wrong: dict[str, object], said: str) -> None:
    with pytest.raises(UsageError, match=said) as raised:
        next(iter(Office(**wrong)))  # type: ignore[arg-type]
    assert "\n" not in str(raised.value)
