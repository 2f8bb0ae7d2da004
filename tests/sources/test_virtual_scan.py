"""Virtual scans of rendered depth images; expected values by plane geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from placecue.depth import Intrinsics, low_percentile, virtual_scan
from placecue.errors import UnusableObservation
from placecue.observation import Pose2D

WIDTH, HEIGHT = 640, 480
KINECT = Intrinsics(fx=525.0, cx=319.5, cy=239.5)
COLUMNS = np.arange(WIDTH)


def image_of(depths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an image of upright walls: every row holds the depths of the columns."""
    return np.tile(depths, (HEIGHT, 1))


def box(left: float, right: float, ahead: float) -> NDArray[np.float64]:
    """Return the depth of each column in a room with walls left, right and ahead, m."""
    sideways = (COLUMNS - KINECT.cx) / KINECT.fx  # m to the right, a metre of depth
    with np.errstate(divide="ignore"):
        side = np.where(sideways > 0, right / sideways, -left / sideways)
    return np.minimum(ahead, side)


def test_a_wall_ahead_is_straight() -> None:
    scan = virtual_scan(image_of(np.full(WIDTH, 2.0)), KINECT)
    x, y = scan.points().T
    # 2 m along the optical axis at every angle, so longer ranges to the sides.
    assert np.abs(x - 2.0).max() < 0.01
    # A beam takes the nearest of half a step to either side.
    assert scan.ranges[0] == pytest.approx(2.0 / math.cos(scan.angles[0]), abs=0.01)
    assert scan.ranges[0] >= 2.0 / math.cos(scan.angles[0] + math.radians(0.25)) - 1e-9
    assert y[0] < 0 < y[-1]


def test_a_round_wall_has_one_range() -> None:
    # A circle of 3 m around the camera: the depth of a point at angle α is 3 cos α.
    angles = np.arctan((COLUMNS - 319.5) / 525.0)
    scan = virtual_scan(image_of(3.0 * np.cos(angles)), KINECT)
    np.testing.assert_allclose(scan.ranges, 3.0, rtol=1e-12)


def test_a_corridor_is_where_it_is() -> None:
    scan = virtual_scan(image_of(box(left=0.8, right=1.2, ahead=4.0)), KINECT)
    x, y = scan.points().T
    # The left wall is met where tan α > 0.8 / 4, that is above 11.3 degrees.
    degrees = np.rad2deg(scan.angles)
    # A beam takes the nearest of a quarter of a degree to either side: 1.7 cm at 4 m.
    assert np.abs(y[degrees > 11.8] - 0.8).max() < 0.018
    assert np.abs(y[degrees < -17.2] + 1.2).max() < 0.018
    assert np.abs(x[(degrees > -16.5) & (degrees < 11.0)] - 4.0).max() < 0.02


def test_beams_lie_at_multiples_of_the_step_and_cover_the_image() -> None:
    scan = virtual_scan(image_of(np.full(WIDTH, 2.0)), KINECT, step=0.5)
    degrees = np.rad2deg(scan.angles)
    half = math.degrees(math.atan(319.5 / 525.0))  # 31.3
    np.testing.assert_allclose(degrees, np.arange(-31.0, 31.01, 0.5), atol=1e-9)
    assert half - 0.5 < degrees[-1] <= half


def test_the_left_of_the_image_has_positive_angles() -> None:
    depths = np.where(COLUMNS < 320, 1.0, 5.0)
    scan = virtual_scan(image_of(depths), KINECT)
    assert (scan.ranges[scan.angles > 0.01] < 1.5).all()
    assert (scan.ranges[scan.angles < -0.01] > 4.5).all()
    assert (np.diff(scan.angles) > 0).all()


def test_an_axis_that_is_not_in_the_middle() -> None:
    scan = virtual_scan(np.full((100, 300), 1.0), Intrinsics(100.0, 200.0, 50.0), band=10, step=1.0)
    # Column 299 is 99 pixels right of the axis, column 0 is 200 pixels left of it.
    assert np.rad2deg(scan.angles[0]) == pytest.approx(-44.0)
    assert np.rad2deg(scan.angles[-1]) == pytest.approx(63.0)


def test_only_the_band_around_the_horizon_counts() -> None:
    image = image_of(np.full(WIDTH, 3.0))
    image[260:] = 1.0  # the floor
    image[:200] = 0.5  # a lamp
    assert np.nanmin(virtual_scan(image, KINECT, band=40).ranges) >= 3.0
    assert virtual_scan(image, KINECT, band=40, horizon=300).ranges.max() < 1.2
    assert virtual_scan(image, KINECT, band=480).ranges.max() < 0.6


def test_the_band_is_centred_on_the_axis() -> None:
    image = np.full((480, 640), 9.0)
    image[238:242] = 1.0
    # The optical axis at row 239.5 has the rows 238 to 241 around it.
    assert virtual_scan(image, KINECT, band=4, percentile=100).ranges.max() < 1.2
    assert virtual_scan(image, KINECT, band=5, percentile=100).ranges.min() >= 9.0


def test_a_few_wrong_pixels_do_no_harm() -> None:
    image = image_of(np.full(WIDTH, 3.0))
    image[230, ::7] = 0.3
    assert virtual_scan(image, KINECT, band=60, percentile=5).ranges.min() >= 3.0
    assert virtual_scan(image, KINECT, band=60, percentile=0).ranges.min() < 0.4


def test_a_low_obstacle_is_seen() -> None:
    image = image_of(np.full(WIDTH, 3.0))
    image[255:, 300:340] = 1.0  # a box that reaches a few rows into the band
    scan = virtual_scan(image, KINECT, band=60)
    ahead = np.abs(scan.angles) < 0.03
    assert scan.ranges[ahead].max() < 1.01
    assert scan.ranges[np.abs(scan.angles) > 0.05].min() >= 3.0


@pytest.mark.parametrize("nothing", [0.0, -1.0, math.nan, math.inf])
def test_invalid_depth_is_left_out(nothing: float) -> None:
    image = image_of(np.full(WIDTH, 2.0))
    image[220:250] = nothing  # half of the band
    image[:, 400:] = nothing
    scan = virtual_scan(image, KINECT, band=60)
    right = np.deg2rad(-9.0)  # column 400 is 8.7 degrees to the right
    assert np.isnan(scan.ranges[scan.angles < right]).all()
    assert not scan.valid()[scan.angles < right].any()
    assert scan.valid()[scan.angles > np.deg2rad(-8.0)].all()
    assert np.nanmin(scan.ranges) >= 2.0


def test_columns_with_too_little_depth_are_invalid() -> None:
    image = np.zeros((480, 640))
    image[235:241] = 2.0  # 6 rows of 60
    assert virtual_scan(image, KINECT, band=60, min_valid=0.1).valid().all()
    assert not virtual_scan(image, KINECT, band=60, min_valid=0.11).valid().any()


def test_a_beam_takes_the_nearest_of_its_columns() -> None:
    depths = np.full(WIDTH, 5.0)
    depths[323] = 1.0  # 0.38 degrees right of the axis: within half a degree of the beam ahead
    scan = virtual_scan(image_of(depths), KINECT, step=1.0)
    assert scan.ranges[np.abs(scan.angles).argmin()] == pytest.approx(1.0, abs=0.001)
    assert (scan.ranges < 2.0).sum() == 1


def test_a_step_finer_than_the_columns_repeats_them() -> None:
    scan = virtual_scan(image_of(box(1.0, 1.0, 3.0)), KINECT, step=0.02)
    assert np.isfinite(scan.ranges).all()
    exact = np.minimum(3.0 / np.cos(scan.angles), 1.0 / np.abs(np.sin(scan.angles) + 1e-12))
    np.testing.assert_allclose(scan.ranges, exact, rtol=0.005)


def test_limits_and_mounting_are_handed_on() -> None:
    mount = Pose2D(0.1, -0.2, math.pi / 2, "base_link")
    scan = virtual_scan(
        image_of(np.full(WIDTH, 2.0)), KINECT, range_min=0.4, range_max=2.2, mount=mount
    )
    assert (scan.range_min, scan.range_max, scan.mount) == (0.4, 2.2, mount)
    # The camera looks to the left of the robot, so the wall is 2 m to the left of it.
    assert np.abs(scan.points()[:, 1] - 1.8).max() < 0.01
    # 2 m ahead is more than 2.2 m away at angles over 24.6 degrees.
    assert (scan.valid() == (np.abs(np.rad2deg(scan.angles)) < 24.6)).all()


@given(st.integers(0, 2**32 - 1), st.floats(0.1, 10.0))
def test_mirrored_and_scaled_images_give_mirrored_and_scaled_scans(
    seed: int, factor: float
) -> None:
    image = np.random.default_rng(seed).uniform(0.0, 4.0, (40, 61))
    image[image < 0.5] = 0.0
    camera = Intrinsics(50.0, 30.0, 20.0)
    scan = virtual_scan(image, camera, band=11, step=1.3)
    mirrored = virtual_scan(image[:, ::-1], camera, band=11, step=1.3)
    np.testing.assert_allclose(mirrored.ranges, scan.ranges[::-1], rtol=1e-9)
    np.testing.assert_allclose(mirrored.angles, -scan.angles[::-1], atol=1e-12)
    scaled = virtual_scan(factor * image, camera, band=11, step=1.3)
    np.testing.assert_allclose(scaled.ranges, factor * scan.ranges, rtol=1e-9)


@given(st.lists(st.floats(0.1, 9.0), min_size=1, max_size=30), st.floats(0, 100))
def test_the_percentile_is_numpys_lower_one(depths: list[float], percentile: float) -> None:
    column = np.array(depths)[:, None]
    with_holes = np.vstack([column, np.full((3, 1), np.nan), np.zeros((2, 1))])
    found = low_percentile(with_holes, percentile, min_valid=0.0)
    assert found[0] == np.percentile(depths, percentile, method="lower")


def test_a_column_without_depth_is_nan_even_if_none_is_needed() -> None:
    assert np.isnan(low_percentile(np.zeros((5, 1)), 5.0, min_valid=0.0)).all()


@pytest.mark.parametrize(
    ("depth", "camera", "options", "message"),
    [
        (np.ones((4, 5, 3)), KINECT, {}, r"this has \(4, 5, 3\)"),
        (np.ones((0, 5)), KINECT, {}, "rows and columns"),
        (
            np.ones((240, 320)),
            Intrinsics(525, 319.5, 239.5),
            {"horizon": 500},
            "no row of the band",
        ),
        (np.ones((120, 160)), KINECT, {}, "another size of image"),
        (np.ones((9, 3)), Intrinsics(500.0, 0.4, 4.0), {"step": 90.0, "band": 3}, None),
        (np.ones((9, 1)), Intrinsics(500.0, 0.2, 4.0), {"step": 1.0, "band": 3}, "no beam"),
    ],
)
def test_what_gives_no_scan(depth, camera, options, message) -> None:  # type: ignore[no-untyped-def]
    if message is None:
        assert len(virtual_scan(depth, camera, **options).angles) == 1
        return
    with pytest.raises(UnusableObservation, match=message):
        virtual_scan(depth, camera, **options)


def test_whole_numbers_are_depths_too() -> None:
    scan = virtual_scan(np.full((HEIGHT, WIDTH), 2, np.uint8), KINECT)
    assert scan.ranges.dtype == np.float64
    assert scan.ranges.min() == pytest.approx(2.0, abs=1e-4)
