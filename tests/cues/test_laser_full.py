"""The preset ``full`` against shapes worked by hand, other libraries, and what must not matter."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from placecue import LaserScan, Observation
from placecue_cues.laser import LaserGeometry
from placecue_cues.scan.beams import Beams
from placecue_cues.scan.fourier import harmonics
from placecue_cues.scan.marks import nearest_minima
from placecue_cues.scan.polygon import Polygons

CUE = LaserGeometry("full")
NAMES, UNITS = CUE.feature_names, CUE.feature_units
Shape = Callable[[np.ndarray], np.ndarray]


def around(count: int) -> np.ndarray:
    return -np.pi + np.arange(count) * 2 * np.pi / count


def features(shape: Shape, angles: np.ndarray, cue: LaserGeometry = CUE) -> dict[str, float]:
    values = cue.extract(Observation(0, scan=LaserScan(angles, shape(angles), 0.0, 100.0)))
    return dict(zip(cue.feature_names, values.tolist(), strict=True))


def walls(*corners: tuple[float, float]) -> Shape:
    """Rays from the origin to the nearest edge of a polygon, solved edge by edge."""
    ends = np.array(corners)

    def ranges(angles: np.ndarray) -> np.ndarray:
        best = np.full(len(angles), np.inf)
        for i, angle in enumerate(angles):
            ray = np.array([np.cos(angle), np.sin(angle)])
            for p, q in zip(ends, np.roll(ends, -1, axis=0), strict=True):
                try:
                    along, share = np.linalg.solve(np.column_stack([ray, p - q]), p)
                except np.linalg.LinAlgError:
                    continue
                if along > 0 and -1e-9 <= share <= 1 + 1e-9:
                    best[i] = min(best[i], along)
        return best

    return ranges


def test_rectangle() -> None:
    # 4 m x 2 m about the scanner: corners lie between beams, which costs under a percent.
    found = features(walls((2, -1), (2, 1), (-2, 1), (-2, -1)), around(720))
    wanted = {
        "area": 8.0,
        "perimeter": 12.0,
        "area_per_perimeter": 8 / 12,
        "form_factor": 4 * np.pi * 8 / 144,
        "compactness": 6 * 8 / (np.pi * (16 + 4)),
        "eccentricity": (16 - 4) / (16 + 4),
        "hu(1)": np.log10(1 + (16 + 4) / (12 * 8) / 1e-7),
        "hu(2)": np.log10(1 + ((16 - 4) / (12 * 8)) ** 2 / 1e-7),
        "line_share": 1.0,
        "minima_distance": 2.0,
        "minima_angle": np.pi,
    }
    for name, value in wanted.items():
        assert found[name] == pytest.approx(value, rel=5e-3), name
    assert max(abs(found[f"hu({i})"]) for i in range(3, 8)) < 0.01
    assert not any(found[name] for name in NAMES if "gaps" in name)


def test_distance_to_the_boundary_of_a_square() -> None:
    # Over half a side of length 1 at height 1: the integral of sqrt(1 + s^2), of 1 + s^2.
    mean = (np.sqrt(2) + np.arcsinh(1)) / 2
    deviation = np.sqrt(4 / 3 - mean**2)
    found = features(walls((1, -1), (1, 1), (-1, 1), (-1, -1)), around(720))
    assert found["boundary_mean"] == pytest.approx(mean, rel=1e-9)
    assert found["boundary_std"] == pytest.approx(deviation, rel=1e-6)
    assert found["boundary_mean_scaled"] == pytest.approx(mean / np.sqrt(2), rel=1e-9)
    # A square is a sum of c_1, c_-3, c_5, c_-7 ..., so its ellipse is a circle.
    assert found["ellipse_ratio"] == pytest.approx(1)
    assert found["fourier(2)"] == pytest.approx(0, abs=1e-9)
    assert found["fourier(-3)"] == pytest.approx(1 / 9, rel=1e-6)
    assert found["fourier(5)"] == pytest.approx(1 / 25, rel=1e-6)


def test_circle() -> None:
    found = features(lambda a: np.full(len(a), 3.0), around(720))
    wanted = {
        "range_mean": 3.0,
        "area": 9 * np.pi,
        "perimeter": 6 * np.pi,
        "boundary_mean": 3.0,
        "boundary_mean_scaled": 1.0,
        "ellipse_major": 3.0,
        "ellipse_minor": 3.0,
        "ellipse_ratio": 1.0,
        "compactness": 1.0,
        "form_factor": 1.0,
        "ratio_mean": 1.0,
        "hu(1)": np.log10(1 + 1 / (2 * np.pi) / 1e-7),
    }
    for name, value in wanted.items():
        assert found[name] == pytest.approx(value, rel=1e-3), name
    zeros = ("difference_mean", "range_std", "boundary_std", "eccentricity", "minima_distance")
    for name in (*zeros, "fourier(-1)", "fourier(2)", "range_kurtosis"):
        assert found[name] == pytest.approx(0, abs=2e-4), name


def test_half_circle_is_closed_by_the_scanner() -> None:
    found = features(lambda a: np.full(len(a), 2.0), np.linspace(-np.pi / 2, np.pi / 2, 181))
    assert found["area"] == pytest.approx(2 * np.pi, rel=1e-3)
    assert found["perimeter"] == pytest.approx(4 + 2 * np.pi, rel=1e-3)


def test_l_shaped_room() -> None:
    # Three unit squares round a corner, seen from the middle of the corner square.
    shape = walls((-0.5, -0.5), (1.5, -0.5), (1.5, 0.5), (0.5, 0.5), (0.5, 1.5), (-0.5, 1.5))
    found = features(shape, around(1440))
    assert found["area"] == pytest.approx(3, rel=0.01)
    assert found["perimeter"] == pytest.approx(8, rel=0.02)
    # Of three unit squares at (0, 0), (1, 0), (0, 1) about their common centroid (1/3, 1/3):
    second = 3 / 12 + (1 + 4 + 1) / 9
    mixed = (1 - 2 - 2) / 9
    assert found["compactness"] == pytest.approx(9 / (4 * np.pi * second), rel=0.02)
    assert found["eccentricity"] == pytest.approx(2 * abs(mixed) / (2 * second), rel=0.02)
    assert found["minima_distance"] > 0


CORRIDOR = walls((-9, -1), (9, -1), (9, 1), (-9, 1))
OFF_CENTRE = walls((-9, -0.6), (9, -0.6), (9, 1.4), (-9, 1.4))
DEAD_END = walls((-9, -1), (1.5, -1), (1.5, 3), (-9, 3))


@pytest.mark.parametrize(
    ("room", "distance", "angle"),
    [
        (CORRIDOR, 2.0, np.pi),  # the walls at both sides are nearest where the scan ends
        (OFF_CENTRE, 2.0, np.pi),
        (DEAD_END, np.hypot(1, 1.5), np.pi / 2),  # at the right end and straight ahead
    ],
)
def test_the_ends_of_a_scan_can_be_minima(room: Shape, distance: float, angle: float) -> None:
    found = features(room, np.radians(np.arange(-90, 90.5, 0.5)))
    assert found["minima_distance"] == pytest.approx(distance, rel=1e-4)
    assert found["minima_angle"] == pytest.approx(angle, rel=1e-4)


def test_the_ends_of_a_full_turn_are_one_place() -> None:
    # The nearest wall is behind, where the turn begins and ends; the next one is ahead.
    found = features(walls((-1, -5), (2, -5), (2, 5), (-1, 5)), around(720))
    assert found["minima_distance"] == pytest.approx(3.0, rel=1e-4)
    assert found["minima_angle"] == pytest.approx(np.pi, rel=1e-4)


def test_noise_at_the_end_of_a_scan_makes_no_minimum() -> None:
    ranges = np.full(361, 5.0)
    ranges[1], ranges[200] = 4.95, 4.0  # beside the end too shallow, and one that is deep enough
    assert nearest_minima(ranges, cyclic=False, depth=0.1).size == 0
    ranges[2] = 5.2  # now the range rises between them by more
    np.testing.assert_array_equal(nearest_minima(ranges, cyclic=False, depth=0.1), [200, 1])


def test_jump_stays_one_jump_when_the_beams_are_coarse() -> None:
    def door(angles: np.ndarray) -> np.ndarray:
        return np.where(angles < 0.1, 2.0, 6.0)

    for count in (91, 181, 361, 721):
        found = features(door, np.linspace(-np.pi / 2, np.pi / 2, count))
        assert found["gaps(3)"] == pytest.approx(1 / 361)
        assert found["gaps(5)"] == 0
        assert found["difference_mean"] == pytest.approx(4 / 360, rel=0.05)


def test_beam_statistics_equal_scipy_and_numpy() -> None:
    rng = np.random.default_rng(8)
    ranges = rng.uniform(0.5, 70, 361)
    found = features(lambda a: ranges, np.linspace(-np.pi / 2, np.pi / 2, 361))
    steps, q = np.abs(np.diff(ranges)), np.minimum(ranges[1:], ranges[:-1])
    q = q / np.maximum(ranges[1:], ranges[:-1])
    clipped = np.minimum(ranges, 20)
    wanted = {
        "range_mean": ranges.mean(),
        "range_std": ranges.std(),
        "range_mean(clip=20)": clipped.mean(),
        "range_kurtosis": stats.kurtosis(ranges, fisher=False),
        "difference_mean": steps.mean(),
        "difference_std(clip=20)": np.abs(np.diff(clipped)).std(),
        "gaps(10)": (steps > 10).sum() / 361,
        "relative_gaps(0.3)": (q < 0.3).sum() / 361,
        "ratio_mean": q.mean(),
        "ratio_std": q.std(),
    }
    for name, value in wanted.items():
        assert found[name] == pytest.approx(value, rel=1e-9), name
    assert found["line_share"] < 0.1


def test_harmonics_equal_the_fft_of_the_resampled_boundary() -> None:
    angles = around(60)
    ranges = 3 + np.random.default_rng(2).uniform(-1, 1, (1, 60))
    polygons = Polygons(Beams(ranges, angles, cyclic=True).points)
    closed = np.append(polygons.vertices[0], polygons.vertices[0, 0])
    travelled = np.concatenate([[0], np.cumsum(np.abs(np.diff(closed)))])
    at = np.arange(2**18) / 2**18 * travelled[-1]
    spectrum = np.fft.fft(np.interp(at, travelled, closed)) / len(at)
    found = harmonics(polygons, 20, 20)
    np.testing.assert_allclose(found.positive[0], np.abs(spectrum[1:21]), atol=1e-6)
    np.testing.assert_allclose(found.negative[0], np.abs(spectrum[:-21:-1]), atol=1e-6)


def smooth(angles: np.ndarray) -> np.ndarray:
    return 3 + 0.5 * np.sin(2 * angles) + 0.3 * np.cos(3 * angles + 1)


@settings(max_examples=30, deadline=None)
@given(st.integers(360, 2000), st.sampled_from([57 / 180, 1.0, 1.5, 2.0]))
def test_number_of_beams_does_not_matter(count: int, half_turns: float) -> None:
    def view(beams: int) -> np.ndarray:
        if half_turns == 2.0:
            return around(beams)
        return np.linspace(-np.pi * half_turns / 2, np.pi * half_turns / 2, beams)

    a, b = features(smooth, view(count)), features(smooth, view(1440))
    for name in NAMES:
        assert a[name] == pytest.approx(b[name], rel=0.01, abs=2e-3), name


@pytest.mark.parametrize("degrees", [57, 120, 180, 270, 360])
def test_number_of_beams_does_not_matter_in_a_room_with_corners(degrees: int) -> None:
    room = walls((-0.5, -0.5), (3.5, -0.5), (3.5, 1.2), (1, 1.2), (1, 4), (-0.5, 4))

    def view(step: float) -> np.ndarray:
        count = round(degrees / step)
        if degrees == 360:
            return around(count)
        return np.radians(np.linspace(-degrees / 2, degrees / 2, count + 1))

    fine = features(room, view(0.125))
    for step in (0.25, 0.5, 1.0):
        coarse = features(room, view(step))
        for name in NAMES:
            assert coarse[name] == pytest.approx(fine[name], rel=0.03, abs=0.01), (name, step)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.3, 3.0), st.integers(0, 10**6))
def test_scaling_goes_with_the_units(scale: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.linspace(-2, 2, 459)
    base = smooth(angles) + np.cumsum(rng.normal(0, 0.02, angles.size)).clip(-1, 1)
    a, b = features(lambda _: base, angles), features(lambda _: base * scale, angles)
    power = {"1": 0, "rad": 0, "m": 1, "m²": 2}
    for name, unit in zip(NAMES, UNITS, strict=True):
        if name.startswith(("gaps", "line_share", "minima")) or "clip" in name:
            continue
        assert b[name] == pytest.approx(a[name] * scale ** power[unit], rel=1e-4, abs=1e-6), name


@settings(max_examples=10, deadline=None)
@given(st.sampled_from([57, 120, 180, 270, 360]), st.integers(0, 10**6))
def test_mirrored_scan(view: int, seed: int) -> None:
    half = np.radians(view) / 2
    angles = np.linspace(-half, half, 2 * view + 1)[: 2 * view + (view < 360)]
    rng = np.random.default_rng(seed)
    base = smooth(angles) + np.cumsum(rng.normal(0, 0.02, angles.size)).clip(-1, 1)
    # A full turn has no last beam to swap with the first one.
    mirrored = base[::-1] if view < 360 else np.roll(base[::-1], 1)
    a, b = features(lambda _: base, angles), features(lambda _: mirrored, angles)
    for name in NAMES:
        sign = -1 if name == "hu(7)" else 1
        # Lines are split from the first beam on, so the ends of some move by a beam or two, and a
        # line that is just long enough one way may fall short the other way.
        slack = 0.06 if name == "line_share" else 1e-9
        assert b[name] == pytest.approx(sign * a[name], rel=1e-6, abs=slack), name


def degenerate() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    turn = around(360)
    return {
        "one beam": (np.array([0.3]), np.array([2.0])),
        "two beams": (np.array([0.0, 1.0]), np.array([2.0, 3.0])),
        "two opposite beams": (np.array([0.0, np.pi]), np.array([2.0, 2.0])),
        "two beams in one direction": (np.array([0.5, 0.5]), np.array([2.0, 3.0])),
        "three beams": (np.array([-2.0, 0.0, 2.0]), np.array([1.0, 1.0, 1.0])),
        "all equal": (turn, np.full(360, 0.1)),
        "all at the maximum": (turn, np.full(360, np.nan) * np.r_[np.nan, np.ones(359)]),
        "all but one at the maximum": (turn, np.r_[1.0, np.full(359, np.inf)]),
        "all at the scanner": (turn, np.full(360, 0.0)),
        "next to nothing": (turn, np.full(360, 1e-150)),
        "no area": (np.zeros(50), np.linspace(1, 2, 50)),
    }


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("preset", ["group", "full"])
@pytest.mark.parametrize("name", degenerate())
def test_degenerate_scans_are_finite(name: str, preset: str) -> None:
    angles, ranges = degenerate()[name]
    if np.isnan(ranges).all():
        ranges = np.full(len(angles), 3.4e38)
    scan = LaserScan(angles, ranges, -1.0, float(np.nanmax(np.where(np.isinf(ranges), 80, ranges))))
    values = LaserGeometry(preset).extract(Observation(0, scan=scan))
    assert np.isfinite(values).all()


@pytest.mark.filterwarnings("error")
@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.floats(allow_nan=True, allow_infinity=True), min_size=1, max_size=40),
    st.floats(0.01, 2 * np.pi),
    st.sampled_from(["group", "full"]),
)
def test_any_scan_is_finite(ranges: list[float], view: float, preset: str) -> None:
    angles = np.linspace(0, view, len(ranges))
    scan = LaserScan(angles, np.array([*ranges[:-1], 1.0]), 0.0, 81.9)
    assert np.isfinite(LaserGeometry(preset).extract(Observation(0, scan=scan))).all()


def test_parameters_shape_the_vector() -> None:
    cue = LaserGeometry("full", clips=[7], gaps=[1.0], relative_gaps=[], fourier=3)
    values = features(smooth, around(360), cue)
    assert [name for name in values if "fourier" in name] == [
        "fourier(-1)",
        "fourier(2)",
        "fourier(-2)",
    ]
    assert "range_mean(clip=7)" in values
    assert len(cue.feature_units) == len(values)
