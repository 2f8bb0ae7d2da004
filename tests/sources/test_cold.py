from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pytest

from command_line import succeeds
from placecue.errors import DataError, UsageError
from placecue.logs import open_log
from placecue.observation import EncodedImage
from placecue_sources.categories import category
from placecue_sources.cold import Cold
from placecue_sources.cold_meta import ColdMeta
from recordings import (
    Sample,
    cold_folder,
    cold_name,
    drive,
    needs_data,
    packed,
    picture,
    ramp,
    recorded,
    same,
    write,
)

ROOMS = ("2PO1-A", "CR-A", "TL-B", "1PO-A")


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        # Every label of COLD's annotations, with the rule: "-[A-Z]" at the end, then digits.
        ("1PO-A", "1PO"),
        ("1PO-B", "1PO"),
        ("2PO", "2PO"),
        ("2PO-B", "2PO"),
        ("2PO1-A", "2PO"),
        ("2PO2-A", "2PO"),
        ("CR", "CR"),
        ("CR-B", "CR"),
        ("LAB", "LAB"),
        ("LO-A", "LO"),
        ("ST-A", "ST"),
        ("TL-B", "TL"),
        # The newer labels: floor, category, number.
        ("l4-2PO-1", "2PO"),
        ("l6-CR-12", "CR"),
        ("17", "17"),
        ("kitchen", "kitchen"),
    ],
)
def test_rooms_become_categories(label: str, expected: str) -> None:
    assert category(label) == expected


@pytest.mark.parametrize(("camera", "first"), [("std_cam", 0), ("omni_cam", 255)])
def test_a_sequence_is_converted(tmp_path: Path, camera: str, first: int) -> None:
    samples = drive(labels=ROOMS)
    folder, out = cold_folder(tmp_path, samples), tmp_path / "cold.mcap"
    words = ["source=cold", f"source.path={folder}", f"source.camera={camera}", f"out={out}"]
    assert succeeds("convert", *words).out.startswith("12 observations of seq1_cloudy2")
    found = list(open_log(out))
    assert [o.stamp for o in found] == [s.nanoseconds for s in samples]
    assert [o.label for o in found] == ["2PO"] * 3 + ["CR"] * 3 + ["TL"] * 3 + ["1PO"] * 3
    for number, (observation, sample) in enumerate(zip(found, samples, strict=True)):
        assert isinstance(observation.image_source, EncodedImage)
        shade = number if camera == "std_cam" else first
        assert observation.image_source.data == picture(shade, ".jpg")
        assert observation.pose is not None
        assert observation.pose.x == pytest.approx(sample.x, abs=1e-5)
        assert observation.scan is not None
        np.testing.assert_allclose(observation.scan.ranges, ramp(number, 181), rtol=1e-6)


def test_everything_is_read(tmp_path: Path) -> None:
    samples = drive(labels=ROOMS)
    found = list(Cold(str(cold_folder(tmp_path, samples))))
    assert [o.stamp for o in found] == [s.nanoseconds for s in samples]
    assert [o.label for o in found] == ["2PO"] * 3 + ["CR"] * 3 + ["TL"] * 3 + ["1PO"] * 3
    for number, (observation, sample) in enumerate(zip(found, samples, strict=True)):
        assert observation.pose is not None
        assert observation.scan is not None
        assert (observation.pose.x, observation.pose.frame) == (pytest.approx(sample.x), "map")
        np.testing.assert_allclose(observation.scan.ranges, ramp(number, 181))
        np.testing.assert_allclose(
            np.rad2deg(observation.scan.angles[[0, 90, 180]]), [-90, 0, 90], atol=1e-3
        )
        assert isinstance(observation.image_source, EncodedImage)
        assert observation.image_source.format == "jpeg"
        assert observation.image_source.data == picture(number, ".jpg")


def test_instances_can_be_kept(tmp_path: Path) -> None:
    source = Cold(str(cold_folder(tmp_path, drive(labels=ROOMS))), keep_instances=True)
    assert {o.label for o in source} == set(ROOMS)
    assert source.digest() != Cold(source.path).digest()


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        (
            "freiburg/part_a/seq1_cloudy2",
            {"laboratory": "freiburg", "part": "a", "path": "1"}
            | {"illumination": "cloudy", "run": "2"},
        ),
        (
            "cold-saarbruecken_part_b_seq4_sunny1.tar.gz",
            {"laboratory": "saarbrucken", "part": "b", "path": "4"}
            | {"illumination": "sunny", "run": "1"},
        ),
        (
            "ljubljana/parta-path2/night3",
            {"laboratory": "ljubljana", "part": "a", "path": "2"}
            | {"illumination": "night", "run": "3"},
        ),
        (
            "cold-stockholm/floor4_cloudy_a1",
            {"laboratory": "stockholm", "floor": "4", "illumination": "cloudy", "run": "a1"},
        ),
        (
            "cold-stockholm/floor6_night_b",
            {"laboratory": "stockholm", "floor": "6", "illumination": "night", "run": "b"},
        ),
        ("elsewhere", {}),
    ],
)
def test_names_tell_the_conditions(path: str, expected: dict[str, str]) -> None:
    for kind, dataset in ((Cold, "cold"), (ColdMeta, "cold_meta")):
        found = dict(kind(f"/data/{path}").metadata)
        sequence = Path(path).name.removesuffix(".tar.gz")
        assert found == {"dataset": dataset, "sequence": sequence, **expected}


def test_another_camera_and_a_tar(tmp_path: Path) -> None:
    folder = cold_folder(tmp_path, drive())
    other = next(iter(Cold(str(folder), camera="omni_cam")))
    assert isinstance(other.image_source, EncodedImage)
    assert other.image_source.data == picture(255, ".jpg")
    tar = Cold(str(packed(folder, tmp_path / "seq1_cloudy2.tar.gz", "w:gz", shuffled=True)))
    same(tar, Cold(str(folder)))
    assert tar.digest() == Cold(str(folder)).digest()
    cold_folder(tmp_path, drive(), "seq1_cloudy3")
    with pytest.raises(DataError, match="2 sequences"):
        list(Cold(str(folder.parent)))


def test_what_is_wrong_is_counted_and_said_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    samples = drive(labels=ROOMS)
    folder = cold_folder(tmp_path, samples)
    (folder / "std_cam" / cold_name(samples[0])).unlink()
    (folder / "std_cam" / cold_name(samples[1])).unlink()
    places = folder / "localization" / "places.lst"
    lines = places.read_text().splitlines()
    write(places, "\n".join([*lines[:5], "half", *lines[6:]]))
    with caplog.at_level(logging.WARNING):
        found = list(Cold(str(folder)))
    assert len(found) == 12
    assert [o.has("image") for o in found[:3]] == [False, False, True]
    assert all(o.has("scan") for o in found)
    assert found[5].label is None
    assert found[0].label == "2PO"
    assert len(caplog.records) == 1
    for words in (
        "2 images are missing (the first: t1138915484.1",
        "1 images have no label in places.lst",
        "1 lines do not parse and were left out (the first: localization/places.lst, line 6)",
    ):
        assert words in caplog.text


def test_the_annotations_alone_give_poses_and_labels(tmp_path: Path) -> None:
    samples = drive()
    write(tmp_path / "places.lst", "".join(f"{cold_name(s)} {s.label}\n" for s in samples))
    found = list(Cold(str(tmp_path)))
    assert [o.label for o in found] == [s.label for s in samples]
    assert all(o.has("pose") and not o.has("image") for o in found)


def test_odometry(tmp_path: Path) -> None:
    samples = drive()
    for observation, sample in zip(
        Cold(str(cold_folder(tmp_path, samples)), pose="odometry"), samples, strict=True
    ):
        assert observation.pose is not None
        assert observation.pose.frame == "odom"
        assert np.cos(observation.pose.theta - sample.theta) == pytest.approx(1)


@needs_data
@pytest.mark.parametrize(
    ("laboratory", "route", "sequence"),
    [("freiburg", "parta-path2", "sunny1"), ("saarbrucken", "parta-path1", "night2")],
)
def test_recorded_drives(tmp_path: Path, laboratory: str, route: str, sequence: str) -> None:
    file = "cold/poses.csv.gz"
    samples = recorded(file, 300, laboratory=laboratory, path=route, sequence=sequence)
    source = Cold(str(cold_folder(tmp_path, samples)), keep_instances=True)
    found = list(source)
    assert [(o.stamp, o.label) for o in found] == [(s.nanoseconds, s.label) for s in samples]
    poses = [(o.pose.x, o.pose.y, o.pose.theta) for o in found if o.pose]
    np.testing.assert_allclose(poses, [(s.x, s.y, s.theta) for s in samples], atol=1e-6)
    assert {len(o.scan.ranges) for o in found if o.scan} == {181}


def meta_folder(
    root: Path, samples: list[Sample], separator: str = " ", header: bool = True
) -> Path:
    """A sequence of COLD-Meta: scans at the samples, poses and labels three times as often."""
    folder = root / "cold-stockholm" / "floor4_cloudy_a1"

    def lines(name: str, rows: list[list[object]]) -> None:
        text = ["id timestamp rest"] if header else []
        text += [separator.join(map(str, row)) for row in rows]
        write(folder / name, "\n".join(text) + "\n")

    def at(sample: Sample, third: int) -> str:
        seconds, nano = divmod(sample.nanoseconds + third * 33_333_000, 10**9)
        return f"{seconds}.{nano // 1000:06d}"

    often = [(s, third) for s in samples for third in (0, 1, 2)]
    poses = [[i, at(s, k), s.x, s.y, s.theta] for i, (s, k) in enumerate(often)]
    lines("canonical_poses.dat", poses)
    lines("odometry.dat", [[i, at(s, k), s.x + 5, s.y, s.theta] for i, (s, k) in enumerate(often)])
    lines("labels.dat", [[i, at(s, k), f"l4-{s.label}-1"] for i, (s, k) in enumerate(often)])
    lines("scans.dat", [[i, s.stamp, *ramp(i, 181)] for i, s in enumerate(samples)])
    return folder


@pytest.mark.parametrize("separator", [" ", ",", ", ", "\t"])
@pytest.mark.parametrize("header", [True, False])
def test_meta_is_read(
    tmp_path: Path, separator: str, header: bool, caplog: pytest.LogCaptureFixture
) -> None:
    samples = drive(step=100_000)
    source = ColdMeta(str(meta_folder(tmp_path, samples, separator, header)))
    found = list(source)
    assert not caplog.records
    assert source.count() == 12
    for number, (observation, sample) in enumerate(zip(found, samples, strict=True)):
        pose, scan = observation.pose, observation.scan
        assert pose is not None
        assert scan is not None
        assert (observation.stamp, observation.label) == (sample.nanoseconds, sample.label)
        assert (pose.x, pose.y, pose.theta, pose.frame) == (
            *(pytest.approx(v) for v in (sample.x, sample.y)),
            pytest.approx(pose.theta),
            "map",
        )
        assert np.cos(pose.theta - sample.theta) == pytest.approx(1)
        np.testing.assert_allclose(scan.ranges, ramp(number, 181))
        np.testing.assert_allclose(np.rad2deg(scan.angles[[0, 90, 180]]), [-90, 0, 90], atol=1e-9)


def test_meta_has_parameters_for_what_differs(tmp_path: Path) -> None:
    folder = meta_folder(tmp_path, drive(step=100_000))
    source = ColdMeta(
        str(packed(folder, tmp_path / "floor4_cloudy_a1.tar")),
        keep_instances=True,
        pose="odometry",
        field_of_view=90,
        max_range=2.0,
        ranges_from=3,
    )
    first = next(iter(source))
    assert first.label == "l4-KT-1"
    assert first.pose is not None
    assert first.scan is not None
    assert (first.pose.x, first.pose.frame) == (pytest.approx(10), "odom")
    assert first.scan.ranges.size == 180
    assert np.rad2deg(first.scan.angles[-1]) == pytest.approx(45)
    assert first.scan.valid().sum() == 100
    assert source.digest() != ColdMeta(str(folder)).digest()
    assert ColdMeta(source.path).digest() == ColdMeta(str(folder)).digest()


def test_meta_without_some_files(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = meta_folder(tmp_path, drive(step=100_000))
    (folder / "labels.dat").unlink()
    (folder / "scans.dat").unlink()
    found = list(ColdMeta(str(folder)))
    assert len(found) == 36
    assert all(o.has("pose") and not o.has("scan") and o.label is None for o in found)
    assert len(caplog.records) == 1
    assert "2 files are absent; the rest is read (the first: scans.dat)" in caplog.text
    (folder / "canonical_poses.dat").unlink()
    with pytest.raises(DataError, match=r"no scans.dat and no canonical_poses.dat"):
        list(ColdMeta(str(folder)))


def test_meta_counts_what_is_wrong_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = meta_folder(tmp_path, drive(step=100_000))
    scans = (folder / "scans.dat").read_text().splitlines()
    scans[3] += " far"
    scans[5] = "6 then 1 2"
    scans[7] = " ".join(scans[7].split()[:2])
    write(folder / "scans.dat", "\n".join(scans))
    labels = (folder / "labels.dat").read_text().splitlines()
    write(folder / "labels.dat", "\n".join(labels[:20]))
    found = list(ColdMeta(str(folder)))
    assert len(found) == 9
    assert len(caplog.records) == 1
    assert "2 scans do not parse" in caplog.text
    assert "1 lines do not parse" in caplog.text
    assert "scans have no label near enough in time" in caplog.text


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"pose": "x"}, "available: corrected, odometry"),
        ({"parts": ["sound"]}, "available: image, label, pose, scan"),
        ({"ranges_from": 1}, "at least 2"),
        ({"max_range": 0}, "above 0"),
    ],
)
def test_meta_refuses_wrong_parameters(
    tmp_path: Path, parameters: dict[str, object], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        list(ColdMeta(str(tmp_path), **parameters))  # type: ignore[arg-type]
