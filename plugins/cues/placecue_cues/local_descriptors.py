"""Local descriptors and where in the image they are."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from placecue import call
from placecue.cue import Cue
from placecue.errors import UsageError
from placecue.observation import Observation, Part

Single = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Patches:
    """Descriptors and where they are.

    Parameters
    ----------
    descriptors : ndarray of float32, shape (n, d)
        One a patch.
    places : ndarray of float32, shape (n, 2)
        Row and column of the patch's centre as shares of the image, in [0, 1].
    """

    descriptors: Single
    places: Single


class LocalDescriptors(Cue):
    """A cue of local descriptors that also says where in the image they are."""

    requires: ClassVar[tuple[Part, ...]] = ("image",)

    @abstractmethod
    def patches(self, observation: Observation) -> Patches:
        """Return the descriptors of the observation's image and their places.

        Raises
        ------
        UnusableObservation
            If the image is of no kind that cues take.
        """

    def extract(self, observation: Observation) -> Single:
        """Return the descriptors alone, shape (n, d)."""
        return self.patches(observation).descriptors


def check_descriptors(descriptors: Cue, pyramid: Sequence[int], cue: str) -> None:
    """Raise UsageError, in the name of a cue, unless another can be the descriptors in it."""
    name = type(descriptors).__name__
    if descriptors.learns or descriptors.requires != ("image",):
        raise UsageError(
            f"{cue} needs descriptors of images by a cue that learns nothing, such as dense_sift "
            f"or sift, got {name}"
        )
    if not isinstance(descriptors, LocalDescriptors) and list(pyramid) != [1]:
        raise UsageError(
            f"{cue}: {name} does not say where its descriptors are, so pyramid must be [1], got "
            f"{list(pyramid)}"
        )


def patches_of(descriptors: Cue, observation: Observation, cue: str) -> Patches:
    """Return what a cue of local descriptors sees in an observation.

    Parameters
    ----------
    descriptors : Cue
        The cue of descriptors; where it does not say where they are, all are in one place.
    observation : Observation
        Has an image.
    cue : str
        Who asks, for messages.

    Raises
    ------
    UnusableObservation
        If nothing can be extracted.
    UsageError
        If it is no cue of local descriptors.
    """
    observation.require(descriptors.requires)
    if isinstance(descriptors, LocalDescriptors):
        patches: Patches = call(descriptors, "patches", observation, at=observation)
        return patches
    made = descriptors.features(observation)
    if not (isinstance(made, np.ndarray) and made.ndim == 2):
        raise UsageError(
            f"{cue} needs a cue of local descriptors, such as dense_sift or sift; "
            f"{type(descriptors).__name__} gives one vector an image"
        )
    return Patches(made.astype(np.float32, copy=False), np.zeros((len(made), 2), np.float32))
