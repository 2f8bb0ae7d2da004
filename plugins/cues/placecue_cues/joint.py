"""Several cues as one, for one classifier: integration at the level of features."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any, Self

from placecue import PARTS, call, clone, contracts, step
from placecue.cue import Augmentation, Cue
from placecue.errors import UsageError, described
from placecue.features import FeatureParts
from placecue.observation import Observation, Part


class Joint(Cue):
    """The features of several cues, each a part of its own.

    An observation of which a part can make nothing is unusable as a whole. Where parts have
    augmentations, all of them see the altered observations.

    Parameters
    ----------
    parts : mapping of str to Cue
        The cues by the names of their parts; of dense vectors, sparse histograms or descriptors.

    Attributes
    ----------
    parts_ : dict of str to Cue
        Those that learn, fitted on training observations.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 6.4 (low-level integration).
    """

    def __init__(self, parts: Mapping[str, Cue] | None = None) -> None:
        self.parts = parts

    def check_parameters(self) -> None:  # noqa: D102
        if not isinstance(self.parts, Mapping) or not self.parts:
            raise UsageError(
                "joint needs parts, cues by their names, such as parts={crfh: {plugin: crfh}, "
                f"laser: {{plugin: laser}}}}, got {self.parts!r}"
            )
        for name, cue in self.parts.items():
            if not isinstance(cue, Cue) or isinstance(cue, Joint):
                raise UsageError(
                    f"joint takes cues in one piece as parts, got {described(cue)} as {name!r}"
                )
            if not isinstance(name, str) or not name or "__" in name:
                raise UsageError(f"joint: give part {name!r} a name without '__'")

    @property
    def requires(self) -> tuple[Part, ...]:  # type: ignore[override]
        """What any of the parts requires."""
        needed = {each for cue in self._named.values() for each in cue.requires}
        return tuple(each for each in PARTS if each in needed)

    @property
    def learns(self) -> bool:  # type: ignore[override]
        """Whether a part learns."""
        return any(cue.learns for cue in self._named.values())

    @property
    def families(self) -> Mapping[str, Sequence[str]]:
        """Those of the parts that say any."""
        made = {
            name: step(cue, "families", getattr, cue, "families")
            for name, cue in self._named.items()
        }
        return {name: each for name, each in made.items() if each is not None}

    def prepare(self) -> None:
        """Let the parts get ready."""
        for cue in self._named.values():
            call(cue, "prepare")

    def fit(self, observations: Iterable[Observation], labels: Any = None) -> Self:
        """Fit the parts that learn.

        Parameters
        ----------
        observations : iterable of n observations
            Iterated once for each part that learns, and again as these do.
        labels : array, shape (n,), optional
            Their classes.
        """
        self.check_parameters()
        self.parts_ = {name: clone(cue) for name, cue in self._named.items() if cue.learns}
        for cue in self.parts_.values():
            call(cue, "fit", observations, labels)
        return self

    def extract(self, observation: Observation) -> FeatureParts:
        """Return the features of one observation, in parts."""
        return self.transform([observation])

    def transform(self, observations: Iterable[Observation]) -> FeatureParts:
        """Return the features of n observations, in parts; each part is asked for all at once.

        Raises
        ------
        UnusableObservation
            If a part can make nothing of one of them.
        UsageError
            If a part learns and has not been fitted, or there is none.
        """
        self.check_parameters()
        seen = list(observations)
        at = seen[0] if len(seen) == 1 else None
        check = partial(contracts.batch, n=len(seen))
        return FeatureParts(
            {
                name: call(self._ready(name), "transform", seen, check=check, at=at)
                for name in self._named
            }
        )

    def augmentations(self) -> Sequence[Augmentation]:
        """Return those of all parts."""
        return [
            each
            for cue in self._named.values()
            for each in call(cue, "augmentations", check=contracts.augmentations)
        ]

    @property
    def _named(self) -> Mapping[str, Cue]:
        return self.parts or {}

    def _ready(self, name: str) -> Cue:
        cue = self._named[name]
        if not cue.learns:
            return cue
        if name not in getattr(self, "parts_", {}):
            raise UsageError(f"joint: part '{name}' learns: fit it on training observations first")
        return self.parts_[name]
