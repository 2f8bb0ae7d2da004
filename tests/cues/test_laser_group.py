"""The preset ``group`` agrees with the features of the group's own robot code."""

from pathlib import Path

import numpy as np
import pytest

from placecue import LaserScan, Observation, Pose2D, UnusableObservation, UsageError
from placecue_cues.laser import LaserGeometry


@pytest.fixture(scope="module")
def known(reference: Path) -> dict[str, np.ndarray]:
    with np.load(reference / "laser" / "laser_reference.npz") as data:
        return dict(data)


def observations(known: dict[str, np.ndarray]) -> list[Observation]:
    scans = zip(known["angles"], known["ranges"], known["n"], strict=True)
    return [Observation(0, scan=LaserScan(a[:n], r[:n], 0.0, 100.0)) for a, r, n in scans]


def test_reference_values(known: dict[str, np.ndarray]) -> None:
    cue = LaserGeometry()
    assert cue.feature_names == list(known["feature"])
    found = cue.transform(observations(known))
    assert found.dtype == np.float64
    by_area = np.isin(known["feature"], ["f5", "f7", "f9", "f9_sd", "f29", "f29_sd", "f31"])
    tolerance = np.where(by_area, 1e-4, 1e-5) * np.abs(known["value"])
    assert (np.abs(found - known["value"]) <= tolerance + 1e-12).all()


def test_batches_equal_single_scans(known: dict[str, np.ndarray]) -> None:
    for preset in ("group", "full"):
        cue = LaserGeometry(preset)
        scans = [s for s in observations(known) for _ in range(3)]
        single = np.stack([cue.features(scan) for scan in scans])
        np.testing.assert_allclose(cue.transform(scans), single, rtol=1e-9, atol=1e-12)


def test_invalid_beams_take_the_maximum_range() -> None:
    angles = np.linspace(-1, 1, 9)
    spoilt = np.array([2, np.nan, 3, np.inf, 0.0, -1, 60, 4, 5])
    whole = np.array([2, 8, 3, 8, 8, 8, 8, 4, 5.0])
    for preset in ("group", "full"):
        a, b = (
            LaserGeometry(preset).extract(Observation(0, scan=LaserScan(angles, r, 0.0, 8.0)))
            for r in (spoilt, whole)
        )
        np.testing.assert_array_equal(a, b)


def test_mounting_does_not_enter() -> None:
    angles, ranges = np.linspace(-1.5, 1.5, 40), np.linspace(1, 3, 40)
    mounts = (Pose2D(0, 0, 0, "base_link"), Pose2D(0.3, -0.1, 2.0, "base_link"))
    a, b = (
        LaserGeometry().extract(Observation(0, scan=LaserScan(angles, ranges, 0.0, 8.0, m)))
        for m in mounts
    )
    np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    ("scan", "message"),
    [
        (LaserScan(np.empty(0), np.empty(0), 0.0, 8.0), "empty"),
        (LaserScan(np.arange(3.0), np.full(3, np.nan), 0.0, 8.0), "none of the 3 beams"),
        (LaserScan(np.arange(4.0), np.ones(3), 0.0, 8.0), "3 ranges and 4 angles"),
        (LaserScan(np.arange(3.0)[::-1], np.ones(3), 0.0, 8.0), "do not increase"),
        (LaserScan(np.array([0, np.nan, 1]), np.ones(3), 0.0, 8.0), "hold NaN"),
        (LaserScan(np.arange(2.0), np.array([1.0, np.inf]), 0.0, np.inf), "maximum range"),
    ],
)
def test_unusable_scans(scan: LaserScan, message: str) -> None:
    for preset in ("group", "full"):
        with pytest.raises(UnusableObservation, match=message):
            LaserGeometry(preset).transform([Observation(0, scan=scan)])


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"preset": "gruop"}, "did you mean 'group'"),
        ({"preset": "full", "angular_step": 0.0}, "angular_step=0"),
        ({"preset": "full", "fourier": 0}, "fourier=0"),
    ],
)
def test_wrong_parameters(parameters: dict[str, object], message: str) -> None:
    scan = LaserScan(np.arange(3.0), np.ones(3), 0.0, 8.0)
    with pytest.raises(UsageError, match=message):
        LaserGeometry(**parameters).extract(Observation(0, scan=scan))


def test_missing_scan_and_empty_batch() -> None:
    with pytest.raises(UnusableObservation, match="no scan at stamp 7"):
        LaserGeometry().transform([Observation(7)])
    with pytest.raises(UsageError, match="at least one observation"):
        LaserGeometry().transform([])
