"""Rules that join the cues by a formula, with nothing to learn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue import Evidence, Integrator, UsageError
from placecue_integrators.agreement import check_layouts, class_codes, common_classes


class FixedRule(Integrator, ABC):
    """Joins the cues that are there, class by class.

    A sample that lacks a cue is told by the others; one without any cue cannot be told, and its
    row is NaN.

    Attributes
    ----------
    gaps : bool
        True: takes evidence in which cues are missing for some samples.
    cues_ : list of str
        The cues, in the order in which they are joined.
    layouts_ : list of Layout
        Those of their scores.
    """

    gaps: ClassVar[bool] = True

    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Check that the rule can join these cues; see :meth:`placecue.Integrator.fit`.

        Raises
        ------
        UsageError
            If a cue has scores that the rule cannot take.
        DataError
            If the cues do not tell the same classes apart, or the labels are of others.
        """
        self.check_parameters()
        self.cues_ = list(evidence.cues)
        classes = common_classes(evidence, self.cues_)
        self.layouts_ = [evidence.layout(cue) for cue in self.cues_]
        self._learn(evidence, class_codes(labels, evidence, classes))
        return self

    def _here(self, evidence: Evidence) -> list[str]:
        """Return the cues that there is evidence of: it may be of a cue or of all."""
        foreign = [cue for cue in evidence.cues if cue not in self.cues_]
        if foreign:
            raise UsageError(
                f"there is evidence of cue '{foreign[0]}', and the integrator was fitted on "
                f"{', '.join(self.cues_)}: give it scores of the models that it was fitted with"
            )
        check_layouts(evidence, self.cues_, self.layouts_)
        return [cue for cue in self.cues_ if cue in evidence.cues]

    @abstractmethod
    def _learn(self, evidence: Evidence, codes: NDArray[np.int64]) -> None:
        """Check what the rule alone asks for, and keep what it needs to know of the samples."""


def told(values: NDArray[np.float64], any_cue: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return n rows of scores with NaN where a sample has no cue."""
    return np.asarray(np.where(any_cue[:, None], values, np.nan), dtype=np.float64)
