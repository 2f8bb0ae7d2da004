"""Walls and windows: textures that fill what a robot sees when it looks at little else."""

from __future__ import annotations

import numpy as np
import pytest

from placecue_office.pictures import PICTURES
from placecue_office.plan_file import PLANS, read_plan
from placecue_office.walls import brick, concrete, half_tiled, paint, woodchip

COLOUR = np.array([215.0, 208.0, 190.0])


@pytest.mark.parametrize("draw", [paint, woodchip, brick, half_tiled, concrete])
@pytest.mark.parametrize("pixels", [64, 512])
def test_a_wall_is_lit_paint_of_its_colour(draw, pixels: int) -> None:  # type: ignore[no-untyped-def]
    image = draw(np.random.default_rng(3), COLOUR, pixels)
    assert image.shape == (pixels, pixels, 3)
    assert image.min() >= 0
    assert image.max() <= 255
    np.testing.assert_allclose(np.median(image, axis=(0, 1)), COLOUR, rtol=0.15)
    np.testing.assert_array_equal(image, draw(np.random.default_rng(3), COLOUR, pixels))


def test_bricks_lie_in_courses() -> None:
    image = brick(np.random.default_rng(3), COLOUR, 512).mean(axis=2)
    rows = image.mean(axis=1)[50:400]  # joints that lie make dark rows every 0.075 m
    spectrum = np.abs(np.fft.rfft(rows - rows.mean(), 2700))
    assert 2700 / (100 + spectrum[100:300].argmax()) == pytest.approx(512 * 0.075 / 2.7, rel=0.03)


def test_no_two_windows_show_the_same() -> None:
    windows = [panel for panel in read_plan(PLANS / "idol2_floor.geojson").panels if panel.window]
    assert len(windows) == 6
    assert len({panel.key for panel in windows}) == 6
    drawn = [
        PICTURES["window"](
            np.random.default_rng([5, panel.key, 0]), np.array([216.0, 226, 234]), 128, 128
        )
        for panel in windows
    ]
    for number, one in enumerate(drawn):
        for other in drawn[:number]:
            assert np.abs(one - other).mean() > 10


@pytest.mark.parametrize("name", ["radiator", "curtain"])
def test_what_is_at_a_window_has_folds_or_ribs(name: str) -> None:
    image = PICTURES[name](np.random.default_rng(1), COLOUR, 128, 128).mean(axis=2)[20:100]
    across, down = image.mean(axis=0).std(), image.mean(axis=1).std()
    assert across > 3 * down
