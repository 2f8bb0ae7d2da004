"""The transform buffer against poses worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from placecue.logs.joining.transforms import FEW, TransformBuffer
from placecue.logs.messages.geometry import Transform, flatten, slerp, yaw

S = 1_000_000_000
LEVEL = (0.0, 0.0, 0.0, 1.0)


def turn(theta: float) -> tuple[float, float, float, float]:
    return 0.0, 0.0, math.sin(theta / 2), math.cos(theta / 2)


def put(
    buffer: TransformBuffer,
    t: float,
    parent: str,
    child: str,
    x: float,
    rotation: tuple[float, float, float, float] = LEVEL,
    static: bool = False,
) -> None:
    buffer.add(Transform(parent, child, (x, 0.0, 0.0), rotation, round(t * S)), static)


def x_at(buffer: TransformBuffer, target: str, source: str, t: float) -> float | None:
    found = buffer.lookup(target, source, round(t * S))
    return None if found is None else float(found[0, 3])


def test_between_two_transforms_it_is_interpolated_along_line_and_arc() -> None:
    buffer = TransformBuffer()
    put(buffer, 1.0, "odom", "base", 1.0, turn(3.0))
    put(buffer, 2.0, "odom", "base", 3.0, turn(-3.0))
    found = buffer.lookup("odom", "base", round(1.5 * S))
    assert found is not None
    pose = flatten(found, "odom")
    assert pose.x == pytest.approx(2.0)
    # From 3 to -3 rad the shorter way leads over pi.
    assert abs(pose.theta) == pytest.approx(math.pi)


def test_a_chain_of_moving_and_static_edges_up_and_down_the_tree() -> None:
    buffer = TransformBuffer()
    put(buffer, 0.0, "base", "laser", 0.5, static=True)
    for t in (1.0, 1.5, 2.0):
        put(buffer, t, "map", "odom", 10.0 * t)
        put(buffer, t, "odom", "base", t)
        put(buffer, t, "map", "other", 100.0 * t)
    assert x_at(buffer, "map", "laser", 1.75) == pytest.approx(17.5 + 1.75 + 0.5)
    assert x_at(buffer, "other", "laser", 1.25) == pytest.approx(12.5 + 1.25 + 0.5 - 125.0)
    assert x_at(buffer, "laser", "base", 99.0) == pytest.approx(-0.5)
    assert x_at(buffer, "laser", "nowhere", 1.0) is None


def test_beyond_its_ends_the_nearest_within_the_tolerance_is_taken() -> None:
    buffer = TransformBuffer(tolerance=S // 10)
    put(buffer, 1.0, "odom", "base", 1.0)
    put(buffer, 5.0, "odom", "base", 5.0)
    assert [x_at(buffer, "odom", "base", t) for t in (0.89, 0.91, 1.1, 1.2, 3.0, 4.95, 5.2)] == [
        None, 1.0, 1.0, None, None, 5.0, None,
    ]  # fmt: skip


def test_a_static_one_holds_until_the_next_and_also_before() -> None:
    buffer = TransformBuffer()
    put(buffer, 5.0, "base", "laser", 5.0, static=True)
    put(buffer, 9.0, "base", "laser", 9.0, static=True)
    assert [x_at(buffer, "base", "laser", t) for t in (0.0, 5.0, 8.9, 9.0, 99.0)] == [5, 5, 5, 9, 9]


@pytest.mark.parametrize(
    ("x", "rotation"),
    [
        (math.nan, LEVEL),
        (math.inf, LEVEL),
        (1e9, LEVEL),
        (1.0, (math.nan,) * 4),
        (1.0, (0.0, 0.0, 0.0, 0.0)),
    ],
)
def test_what_says_nothing_is_left_out_and_counted(
    x: float, rotation: tuple[float, float, float, float]
) -> None:
    buffer = TransformBuffer()
    put(buffer, 1.0, "odom", "base", 1.0)
    put(buffer, 1.5, "odom", "base", x, rotation)
    put(buffer, 2.0, "odom", "base", 2.0)
    assert x_at(buffer, "odom", "base", 1.5) == pytest.approx(1.5)
    assert buffer.faults.counts == {"transforms were left out": 1}


def test_quaternions_of_any_length_are_normalised() -> None:
    assert yaw(0.0, 0.0, 1.0, 1.0) == pytest.approx(math.pi / 2)
    buffer = TransformBuffer()
    put(buffer, 1.0, "odom", "base", 0.0, (0.0, 0.0, 7.0, 7.0))
    found = buffer.lookup("odom", "base", S)
    assert found is not None
    np.testing.assert_allclose(found[:2, :2], [[0.0, -1.0], [1.0, 0.0]], atol=1e-12)


def test_slerp_against_a_quarter_turn_about_an_axis_in_space() -> None:
    root = math.sqrt(0.5)
    found = slerp(LEVEL, (root, 0.0, 0.0, root), 1 / 3)
    assert found == pytest.approx((math.sin(math.pi / 12), 0.0, 0.0, math.cos(math.pi / 12)))


def test_circles_and_frames_in_themselves_end() -> None:
    buffer = TransformBuffer()
    put(buffer, 1.0, "a", "b", 1.0)
    put(buffer, 1.0, "b", "a", 1.0)
    put(buffer, 1.0, "c", "c", 1.0)
    assert x_at(buffer, "c", "a", 1.0) is None
    assert buffer.faults.counts.total() == 1


def test_a_frame_hangs_from_each_of_its_parents_in_its_time() -> None:
    buffer = TransformBuffer()
    put(buffer, 0.0, "world", "cart", 100.0, static=True)
    put(buffer, 0.0, "world", "arm", 200.0, static=True)
    for t, parent in ((1.0, "cart"), (1.5, "cart"), (2.0, "arm"), (2.5, "arm")):
        put(buffer, t, parent, "box", t)
    assert x_at(buffer, "world", "box", 1.25) == pytest.approx(101.25)
    assert x_at(buffer, "world", "box", 1.75) == pytest.approx(101.5)  # as tf2: not between parents
    assert x_at(buffer, "world", "box", 2.25) == pytest.approx(202.25)


def test_transforms_out_of_order_are_put_in_order() -> None:
    buffer = TransformBuffer()
    for t in (1.0, 1.6, 1.2, 1.4, 1.4):
        put(buffer, t, "odom", "base", 10 * t)
    assert x_at(buffer, "odom", "base", 1.3) == pytest.approx(13.0)
    assert len(buffer.edges["base"].history) == 4


def test_the_past_is_forgotten() -> None:
    buffer = TransformBuffer()
    for i in range(10_000):
        put(buffer, 0.01 * i, "odom", "base", 0.01 * i)
        buffer.forget_before(round((0.01 * i - 0.5) * S))
    assert len(buffer.edges["base"].history) < 50 + 2 * FEW
    assert x_at(buffer, "odom", "base", 99.705) == pytest.approx(99.705)
