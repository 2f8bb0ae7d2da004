"""Gist tells gratings apart by scale, direction and place, and nothing else."""

import numpy as np
import pytest

from pictures import grey_photograph, observe
from placecue_cues.gist import Gist, bank


def grating(frequency: float, turn: float, side: int = 128) -> np.ndarray:
    """Grey levels that wave ``frequency`` times a pixel in direction ``turn``, rad."""
    y, x = np.mgrid[:side, :side]
    wave = np.sin(2 * np.pi * frequency * (x * np.cos(turn) + y * np.sin(turn)))
    return np.rint(128 + 60 * wave).astype(np.uint8)


@pytest.mark.parametrize("scale", range(4))
@pytest.mark.parametrize("k", range(8))
def test_each_filter_answers_to_its_grating_most(scale: int, k: int) -> None:
    image = grating(0.3 / 1.85**scale, -np.pi * k / 8)
    energies = Gist(prefilter=0.0).features(observe(image)).reshape(32, 16).mean(axis=1)
    # Without the filter for local mean, that leaks into the coarsest scale.
    assert energies[: 8 * (scale + 1)].argmax() == 8 * scale + k


def test_values_are_those_of_the_formula() -> None:
    # A filter passes a grating of its own frequency, as one complex wave, at half its height.
    size, margin = 128, 16
    cycles = 40
    frequency = cycles / (size + 2 * margin)
    found = bank((8, 8, 8, 8), size + 2 * margin)[:, 0, cycles]
    for scale in range(4):
        radial = np.exp(-10 * 0.35 * (frequency / (0.3 / 1.85**scale) - 1) ** 2)
        for k in range(8):
            turn = np.pi * k / 8
            wanted = radial * np.exp(-2 * (16 * 8**2 / 32**2) * np.pi * turn**2)
            assert found[8 * scale + k] == pytest.approx(wanted, rel=1e-5, abs=1e-30)


def test_energy_lies_where_the_texture_is() -> None:
    image = np.full((128, 128), 128, np.uint8)
    image[64:96, 32:64] = grating(0.15, 0.0)[:32, :32]
    energies = Gist().features(observe(image)).reshape(32, 4, 4).sum(axis=0)
    assert np.unravel_index(energies.argmax(), (4, 4)) == (2, 1)
    assert energies[0, 3] < 0.1 * energies[2, 1]


def test_lighting_and_image_size_hardly_matter() -> None:
    image = grey_photograph()
    found = Gist().features(observe(image))
    darker = Gist().features(observe((image // 2 + 20).astype(np.uint8)))
    assert np.corrcoef(found, darker)[0, 1] > 0.95
    twice = np.repeat(np.repeat(image, 2, axis=0), 2, axis=1)
    np.testing.assert_allclose(Gist().features(observe(twice)), found, atol=0.02)


def test_parameters_shape_the_vector() -> None:
    assert Gist().features(observe(grey_photograph())).shape == (512,)
    other = Gist([8, 4], grid=2, size=64).features(observe(grey_photograph()))
    assert other.shape == (12 * 4,)
    assert other.dtype == np.float32
