"""Routes, worlds that are shipped, and the config of the benchmark."""

from __future__ import annotations

import csv
import gzip
import os
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hydra import compose, initialize_config_module
from omegaconf import OmegaConf

from placecue.components.options import register_with_hydra
from placecue.errors import DataError, UsageError
from placecue_office.explore import Explorer
from placecue_office.route import Planner
from placecue_office.simulator import Office

DATA = os.environ.get("PLACECUE_DATA")
needs_poses = pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")
NAMES = {
    "BO": "one_person_office",
    "EO": "two_person_office",
    "CR": "corridor",
    "KT": "kitchen",
    "PA": "printer_area",
}


def labels(office: Office) -> list[str | None]:
    return [office.built.label_at(x, y) for x, y, _ in office.true_poses.tolist()]


def test_a_robot_that_explores_sees_every_room_and_leaves_no_edge() -> None:
    office = Office(route="explore")
    assert set(labels(office)) == {room.label for room in office.built.plan.rooms}
    built = office.built
    planner = Planner(built.plan, built.clearance, 0.32, np.random.default_rng(0))
    explorer = Explorer(planner, built.geometry.cut(0.3))
    explorer.explore(built.plan.tour[0])
    reachable = np.isin(np.arange(explorer.known.size), planner.reachable)
    assert explorer.known.ravel()[reachable].mean() > 0.98


def test_an_explorer_sees_no_farther_than_its_reach() -> None:
    office = Office(clutter=0, walkers=0)
    built = office.built
    planner = Planner(built.plan, built.clearance, 0.32, np.random.default_rng(0))
    explorer = Explorer(planner, built.geometry.cut(0.3), reach=2.0)
    start = planner.snap(built.plan.tour[:1], 0.32)[0]
    explorer._look(int(start))
    seen = planner.centres[explorer.known.ravel()]
    away = np.linalg.norm(seen - planner.centres[start], axis=1)
    assert 1.8 < away.max() <= 2.0 + planner.raster.cell


def write_poses(path: Path) -> Path:
    rows = ["sequence,stamp,x,y,theta,label"]
    rows += [f"dum_night2,{100 + 0.2 * i:.2f},6.2,{9 + 0.1 * i:.2f},1.57,CR" for i in range(20)]
    with gzip.open(path, "wt") as file:
        file.write("\n".join(rows) + "\n")
    return path


def test_a_recorded_drive_gives_its_poses_and_times(tmp_path: Path) -> None:
    poses = str(write_poses(tmp_path / "poses.csv.gz"))
    drive = list(Office(route="idol2", poses=poses, illumination="night", run=2, pose="truth"))
    assert [each.stamp for each in drive[:2]] == [100_000_000_000, 100_200_000_000]
    assert drive[19].pose is not None
    assert (drive[19].pose.x, drive[19].pose.y) == (6.2, 10.9)
    assert {each.label for each in drive} == {"corridor"}
    assert drive[3].image is not None


def test_what_is_wrong_with_recorded_poses_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses = str(write_poses(tmp_path / "poses.csv.gz"))
    with pytest.raises(DataError, match=r"no sequence 'dum_sunny2'.*dum_night2"):
        Office(route="idol2", poses=poses, illumination="sunny", run=2).count()
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(DataError, match="no CSV of recorded poses"):
        Office(route="idol2", poses=str(tmp_path / "other.csv")).count()
    monkeypatch.delenv("PLACECUE_DATA", raising=False)
    with pytest.raises(UsageError, match="PLACECUE_DATA"):
        Office(route="idol2").count()
    with pytest.raises(UsageError, match="did you mean 'explore'"):
        Office(route="explor").count()


@needs_poses
def test_labels_of_all_recorded_poses_agree_with_the_position(tmp_path: Path) -> None:
    office = Office()
    with gzip.open(Path(str(DATA)) / "idol2" / "poses.csv.gz", "rt") as file:
        rows = list(csv.DictReader(file))
    told = [office.built.label_at(float(row["x"]), float(row["y"])) for row in rows]
    differ = sum(NAMES[row["label"]] != label for row, label in zip(rows, told, strict=True))
    assert len(rows) == 11_440
    assert differ == 0


@needs_poses
def test_nothing_stands_where_a_recorded_drive_goes() -> None:
    office = Office(route="idol2", run=4, illumination="sunny", walkers=0)
    assert office.count() == 999
    clearance = office.built.clearance.at(office.true_poses[:, :2])
    assert clearance.min() > 0.05  # of furniture that the data set's own plan has there
    assert np.mean(clearance > 0.2) > 0.98


def test_the_second_building_has_other_instances_of_the_same_categories() -> None:
    office = Office(world="second_floor")
    counts = Counter(labels(office))
    assert set(counts) == {"office", "corridor", "kitchen", "meeting_room"}
    rooms = Counter(room.label for room in office.built.plan.rooms)
    assert rooms["office"] >= 8
    assert rooms["kitchen"] >= 2
    assert rooms["meeting_room"] >= 3
    visited = np.unique(office.built.plan.room_at(office.true_poses[:, :2]))
    assert len(visited) == len(office.built.plan.rooms)


def test_the_benchmark_is_twelve_sequences() -> None:
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = compose(
            "convert",
            ["world=office_idol", "source.run=3", "out_dir=x"],
            return_hydra_config=True,
        )
        assert config.out == "x/world0/idol_cloudy3.mcap"
        swept = OmegaConf.to_container(config.hydra.sweeper.params)
    assert swept == {"source.illumination": "cloudy,night,sunny", "source.run": "1,2,3,4"}
    assert config.source.plugin == "office"


def test_a_sequence_of_the_benchmark_is_as_long_as_in_idol2() -> None:
    office = Office(speed=0.4, turn_rate=0.7, run=4, illumination="sunny")
    assert 800 <= office.count() <= 1100
