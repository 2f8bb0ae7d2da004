"""Pictures that tests of cues share."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from placecue import Observation

DATA = Path(__file__).parent / "data" / "crfh"


def observe(image: np.ndarray) -> Observation:
    return Observation(0, image=image)


def photograph(name: str = "astronaut") -> np.ndarray:
    return cv2.cvtColor(cv2.imread(str(DATA / f"{name}.png")), cv2.COLOR_BGR2RGB)


def grey_photograph(name: str = "camera") -> np.ndarray:
    return cv2.cvtColor(photograph(name), cv2.COLOR_RGB2GRAY)


def in_every_form(grey: np.ndarray) -> list[np.ndarray]:
    """The same picture in 8-bit grey, RGB, and 16-bit grey."""
    return [grey, np.repeat(grey[:, :, None], 3, axis=2), grey.astype(np.uint16) * 257]


def stripes(wavelength: float, turn: float, seed: int, side: int = 96) -> np.ndarray:
    """A noisy grating whose grey levels rise in direction ``turn``, rad."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:side, :side]
    phase = 2 * np.pi * (x * np.cos(turn) + y * np.sin(turn)) / wavelength + rng.uniform(0, 6)
    return np.clip(128 + 80 * np.sin(phase) + rng.normal(0, 12, y.shape), 0, 255).astype(np.uint8)
