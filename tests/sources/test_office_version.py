"""The frozen worlds of a version: what a seed draws, in numbers pinned when it was frozen.

Where this fails the worlds are others than those of docs/benchmark.md: undo what changed them, or
raise ``placecue_office.simulator.VERSION``, run the benchmark anew, and pin again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from placecue_office.simulator import VERSION, Office
from placecue_office.trace import cast


class Recording(NamedTuple):
    """A recording, and what is known of it."""

    seed: int
    run: int
    count: int
    faces: int
    length: float
    pose: tuple[float, float]
    beams: tuple[float, float, float]
    texel: float
    light: float


#: Moment, and directions of the beams (rad).
MOMENT, BEARINGS = 200, np.array([0.3, 2.0, 4.0])
PINNED = [
    Recording(
        seed=7,
        run=1,
        count=420,
        faces=1312,
        length=681.40491550,
        pose=(5.62954256, 22.34343537),
        beams=(1.39118462, 0.83995006, 0.53476015),
        texel=146.331683,
        light=0.25673515,
    ),
    Recording(
        seed=105,
        run=3,
        count=423,
        faces=1336,
        length=694.91804125,
        pose=(3.33371449, 22.14112566),
        beams=(4.13078068, 0.75108131, 1.04537930),
        texel=140.019549,
        light=0.28595087,
    ),
]


def measured(seed: int, run: int) -> Recording:
    """Return what the numbers of a recording are now."""
    office = Office(seed=seed, run=run, walkers=0)
    geometry, (x, y) = office.built.geometry, office.true_poses[MOMENT, :2].tolist()
    faces = geometry.faces
    return Recording(
        seed,
        run,
        office.count(),
        len(faces),
        float(np.hypot(*(faces[:, :2] - faces[:, 2:]).T).sum()),
        (x, y),
        tuple(cast(geometry.cut(0.3), x, y, BEARINGS).tolist()),  # type: ignore[arg-type]
        float(office.built.skin.texels.mean()),
        float(office.built.ground.light.mean()),
    )


@pytest.mark.parametrize("pinned", PINNED, ids=lambda each: f"world {each.seed}, run {each.run}")
def test_a_seed_draws_the_world_that_it_drew(pinned: Recording) -> None:
    assert VERSION == 3
    now = measured(pinned.seed, pinned.run)
    for name, value, known in zip(pinned._fields, now, pinned, strict=True):
        assert value == pytest.approx(known, rel=1e-4), name
