"""G-DAS: the weighted sum of the outputs of all cues."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from placecue.checks import check_choice, check_number
from placecue.errors import DataError, UsageError, choices
from placecue.evidence import Evidence
from placecue.integrator import Integrator
from placecue.scores import ModifiedOneAgainstAll, Scores

from .equal_layouts import common_layout
from .simplex import steps_of
from .weight_search import best_weights, weighted_sum

Matrix = NDArray[np.float64]
SEARCH, EQUAL = "search", "equal"
DISTANCES, SUMS = "sum_of_distances", "distance_of_sums"


class GDAS(Integrator):
    """Generalised discriminative accumulation: V_v = sum_t sigma_t V_(t,v), sigma_t >= 0.

    The outputs of all cues, raw, are added up under one weight a cue, which all must have in one
    layout; the layout's own multi-class rule and confidence then apply to the sums.

    Parameters
    ----------
    weights : {"search", "equal"} or mapping of str to float
        ``search`` tries every weighting of the cues in steps of ``step`` that sums to 1, for the
        best balanced accuracy on the held-out scores. Of equally good ones the most even is
        taken, that of the smallest sum of squares, then the one with more weight on the earlier
        cues. ``equal`` is 1 / T each. Weights by the name of the cue are divided by their sum;
        those of cues that are not there do not count, and where no other is above 0, the cues
        that are there weigh the same.
    step : float
        What the weights are multiples of in the search; it parts 1 evenly. T cues have
        C(1 / step + T - 1, T - 1) weightings: at 0.05, 1771 for four.
    modified_oaa : {"sum_of_distances", "distance_of_sums"}
        Modified one-against-all: the class of the least sum_t sigma_t abs(D_t - mean_t), as
        in the group's code, or of the least abs(sum_t sigma_t (D_t - mean_t)). The scores are the
        sums, of distances (none below 0) or of signed differences; the layout's own rule takes
        the class whose sum is nearest to 0.

    Attributes
    ----------
    cues_ : list of str
        The cues.
    weights_ : ndarray of float64, shape (T,)
        Their weights, which sum to 1.
    balanced_accuracy_ : float or None
        That of the weights on the held-out scores; None where they were not searched.
    layout_ : Layout
        What the columns of the scores are.

    References
    ----------
    Pronobis et al., IJRR 29(2-3), 2010, section 4.1; Pronobis and Caputo, IROS 2007. The grid and
    its ties: our choice.
    """

    #: What a cue alone says must be of the same kind as the sums: distances, say.
    fits_alone: ClassVar[bool] = True

    def __init__(
        self,
        weights: str | Mapping[str, float] = SEARCH,
        step: float = 0.05,
        modified_oaa: str = DISTANCES,
    ) -> None:
        self.weights = weights
        self.step = step
        self.modified_oaa = modified_oaa

    def check_parameters(self) -> None:  # noqa: D102
        if isinstance(self.weights, Mapping):
            _check_weights(self.weights)
        else:
            check_choice("weights", self.weights, (SEARCH, EQUAL))
        check_number("step", self.step, above=0, most=1)
        steps_of(self.step)
        check_choice("modified_oaa", self.modified_oaa, (DISTANCES, SUMS))

    def check_cues(self, cues: Sequence[str]) -> None:  # noqa: D102
        if isinstance(self.weights, Mapping):
            for named in self.weights:
                if named not in cues:
                    raise UsageError(
                        f"gdas has a weight for cue '{named}', which is not there; "
                        f"{choices(named, cues)}"
                    )
            _check_named(self.weights, cues)

    def fit(self, evidence: Evidence, labels: ArrayLike, stamps: ArrayLike | None = None) -> Self:
        """Find the weights; see :meth:`placecue.integrator.Integrator.fit`.

        Samples that lack a cue are left out.

        Raises
        ------
        UsageError
            If a parameter cannot be, a cue has no weight, or two cues differ in their layouts.
        DataError
            If the weights are searched and no sample has scores of all cues, or a label is none of
            the classes of the scores.
        """
        self.check_parameters()
        self.layout_ = common_layout(evidence, "gdas")
        self.cues_ = list(evidence.cues)
        self.balanced_accuracy_: float | None = None
        if isinstance(self.weights, Mapping):
            self.weights_ = _shares(self.weights, self.cues_)
        elif self.weights == EQUAL:
            self.weights_ = np.full(len(self.cues_), 1 / len(self.cues_))
        else:
            outputs, codes = self._samples(evidence, np.asarray(labels))
            found = best_weights(outputs, self.layout_, codes, steps_of(self.step))
            self.weights_, self.balanced_accuracy_ = found
        return self

    def integrate(self, evidence: Evidence) -> Scores:
        """Return the weighted sums, in the layout of the cues.

        NaN for observations that lack a cue.

        Raises
        ------
        UsageError
            If the scores of a cue are of another layout than in fitting, or there are none.
        """
        return Scores(weighted_sum(self.weights_, self._outputs(evidence)), self.layout_)

    def summary(self) -> str:
        """Return the weights."""
        pairs = zip(self.cues_, self.weights_, strict=True)
        told = ", ".join(f"{cue} {weight:.2f}" for cue, weight in pairs)
        rate = self.balanced_accuracy_
        return f"weights {told}" + ("" if rate is None else f", {100 * rate:.1f} % on held-out")

    def check_learned(self) -> None:
        """Raise ValueError where weights that were loaded are none."""
        weights = self.weights_
        if weights.shape != (len(self.cues_),) or not (np.isfinite(weights) & (weights >= 0)).all():
            raise ValueError("the weights of gdas are not one number of at least 0 a cue")

    def _outputs(self, evidence: Evidence) -> list[Matrix]:
        """Return what is added up of each cue, shape (n, V) each."""
        found = [evidence.scores(cue) for cue in self.cues_]
        for cue, scores in zip(self.cues_, found, strict=True):
            if scores.layout is not self.layout_ and scores.layout != self.layout_:
                raise UsageError(
                    f"the scores of cue '{cue}' are {scores.layout}, and gdas was fitted on "
                    f"{self.layout_}: give it scores of the models that it was fitted with"
                )
        distances = self.modified_oaa == DISTANCES
        if distances and isinstance(self.layout_, ModifiedOneAgainstAll):
            return [np.abs(scores.values) for scores in found]
        return [scores.values for scores in found]

    def _samples(
        self, evidence: Evidence, labels: NDArray[np.str_]
    ) -> tuple[Matrix, NDArray[np.int64]]:
        """Return the outputs for samples that have all cues, (T, n, V), and their classes, (n,)."""
        if labels.shape != (len(evidence),):
            raise DataError(
                f"evidence of {len(evidence)} samples and labels of shape {labels.shape}: give "
                "one label a sample"
            )
        outputs = np.stack(self._outputs(evidence))
        rows = ~np.isnan(outputs).any(axis=(0, 2))
        if not rows.any():
            raise DataError(f"no sample has scores of all cues ({', '.join(self.cues_)})")
        return outputs[:, rows], _codes(labels[rows], self.layout_.classes)


def _codes(labels: NDArray[np.str_], classes: Sequence[str]) -> NDArray[np.int64]:
    """Return the numbers of classes, shape (n,)."""
    for label in np.unique(labels):
        if label not in classes:
            raise DataError(
                f"samples are labelled '{label}', which is no class of the scores "
                f"({', '.join(classes)}): leave them out"
            )
    return np.searchsorted(np.asarray(classes), labels).astype(np.int64)


def _check_weights(weights: Mapping[str, float]) -> None:
    for cue, weight in weights.items():
        check_number(f"weights.{cue}", weight, least=0)
        if not isfinite(weight):
            raise UsageError(f"weights.{cue} is {weight}; give a finite number")
    if not any(weights.values()):
        raise UsageError(f"weights are all 0 ({', '.join(weights)}): give a cue more than that")


def _check_named(weights: Mapping[str, float], cues: Sequence[str]) -> None:
    for cue in cues:
        if cue not in weights:
            raise UsageError(
                f"gdas has no weight for cue '{cue}', only for {', '.join(weights)}: give each "
                "cue one, 0 to leave it out, or weights=search"
            )


def _shares(weights: Mapping[str, float], cues: Sequence[str]) -> Matrix:
    """Return the given weights of cues, divided by their sum; equal ones where that is 0."""
    _check_named(weights, cues)
    given = np.array([weights[cue] for cue in cues], dtype=np.float64)
    if not given.any():
        given[:] = 1
    return np.asarray(given / given.sum())
