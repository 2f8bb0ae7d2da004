"""A cue: what is looked at in an observation."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from typing import Any, ClassVar, Self, TypeAlias

from placecue import contracts
from placecue.estimator import Estimator
from placecue.features import Families, FeatureBatch, Features, stack
from placecue.guard import call
from placecue.observation import Observation, Part

#: Makes an altered copy of an observation; see :meth:`Observation.altered`.
Augmentation: TypeAlias = Callable[[Observation], Observation]


class Cue(Estimator, ABC):
    """Turns an observation into features: a scikit-learn transformer over observations.

    A subclass sets ``requires`` and writes :meth:`extract`. One that learns from data (a codebook,
    say) also sets ``learns`` and overrides :meth:`fit`; it is then fitted on training observations
    only, anew inside every fold.

    Attributes
    ----------
    requires : tuple of {"image", "scan", "pose"}
        The parts of an observation that :meth:`extract` needs.
    version : str
        Changes when the features do, so that cached ones, and those that a model was trained on,
        are not mistaken for them.
    learns : bool
        Whether :meth:`fit` learns anything.
    """

    requires: ClassVar[tuple[Part, ...]] = ()
    version: ClassVar[str] = "1"
    learns: ClassVar[bool] = False

    @property
    def families(self) -> Families | None:
        """The family that each feature of a dense vector belongs to, d names.

        Features of a family say much the same, such as counts at several thresholds; a scaling
        may weigh families rather than features (:class:`placecue.FamilyScaling`). None, the
        default, says nothing. Of features in parts it is a mapping, from the dense parts of which
        it is known to d names each.
        """
        return None

    @abstractmethod
    def extract(self, observation: Observation) -> Features:
        """Return the features of one observation.

        Parameters
        ----------
        observation : Observation
            Has every part in ``requires``.

        Returns
        -------
        ndarray of shape (d,), csr_array of shape (1, bins), or ndarray of shape (k, d)
            A dense vector, a sparse histogram, or k local descriptors.

        Raises
        ------
        UnusableObservation
            If nothing can be extracted from this observation.
        """

    def fit(self, observations: Iterable[Observation], labels: Any = None) -> Self:
        """Learn from training observations; the default learns nothing."""
        return self

    def prepare(self) -> None:
        """Get ready, before features are extracted or looked for where they were kept.

        For cues that read a file, such as a network: they keep its digest under a name that ends
        in ``_``, so that the feature cache and a model know which file the features are of. It may
        be called any number of times. The default does nothing.
        """

    def augmentations(self) -> Sequence[Augmentation]:
        """Return what training does to each observation to get further samples of its class.

        Copies are trained on with their sample and never scored. The default is none.
        """
        return ()

    def transform(self, observations: Iterable[Observation]) -> FeatureBatch:
        """Return the features of several observations as one batch.

        Raises
        ------
        UnusableObservation
            If one of them lacks a part in ``requires``, or nothing can be extracted from it.
        """
        return stack([self.features(observation) for observation in observations])

    def features(self, observation: Observation) -> Features:
        """Return the features of one observation after checking that its parts are there."""
        observation.require(self.requires)
        made: Features = call(
            self, "extract", observation, check=contracts.features, at=observation
        )
        return made

    def fit_transform(
        self, observations: Iterable[Observation], labels: Any = None
    ) -> FeatureBatch:
        """Fit on the observations, then transform them; they are iterated twice."""
        return self.fit(observations, labels).transform(observations)
