"""A bounded random sample of the local descriptors of many observations."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, UnusableObservation
from placecue.faults import Faults
from placecue.observation import Observation
from placecue.progress import track

Single = NDArray[np.float32]


def descriptor_sample(
    observations: Iterable[Observation],
    describe: Callable[[Observation], Single],
    size: int,
    random_state: int,
    enough: int,
    cue: str,
) -> Single:
    """Return a random sample of all observations' descriptors, uniform over them.

    At most three times ``size`` descriptors and those of one observation are held at a time.

    Parameters
    ----------
    observations : iterable of Observation
        Iterated once; unusable ones are passed over and reported once.
    describe : callable
        Gives the (n, d) descriptors of an observation; raises UnusableObservation where there
        is nothing to describe.
    size : int
        How many to return at most.
    random_state : int
        Seed.
    enough : int
        How many are needed at least.
    cue : str
        Who learns, for messages.

    Returns
    -------
    ndarray of float32, shape (k, d)

    Raises
    ------
    DataError
        If no observation is usable, or all together have fewer than ``enough`` descriptors.
    """
    generator = np.random.default_rng(random_state)
    faults, total = Faults(), 0
    kept: list[Single] = []
    draws: list[NDArray[np.float64]] = []
    for observation in track(observations, f"learning {cue}"):
        total += 1
        try:
            descriptors = describe(observation)
        except UnusableObservation as error:
            faults.pass_over(error)
            continue
        draw = generator.random(len(descriptors))
        # Of one image no more than can be returned: those with the smallest draws.
        chosen = _smallest(draw, size)
        kept.append(descriptors[chosen])
        draws.append(draw[chosen])
        if sum(map(len, draws)) > 2 * size:
            kept, draws = _cut(kept, draws, size)
    faults.report_of(total)
    count = sum(map(len, draws))
    if count < enough:
        raise DataError(
            f"{cue} learns from {enough} local descriptors or more, got {count} from {total} "
            "training images: give more images, or fewer words or Gaussians"
        )
    return _cut(kept, draws, size)[0][0]


def _smallest(draw: NDArray[np.float64], size: int) -> NDArray[np.int64]:
    """Return where the smallest draws are, in their order in the array."""
    if len(draw) <= size:
        return np.arange(len(draw))
    return np.sort(np.argpartition(draw, size)[:size])


def _cut(
    kept: list[Single], draws: list[NDArray[np.float64]], size: int
) -> tuple[list[Single], list[NDArray[np.float64]]]:
    """Keep the descriptors with the smallest draws."""
    every, draw = np.concatenate(kept), np.concatenate(draws)
    chosen = _smallest(draw, size)
    return [every[chosen]], [draw[chosen]]
