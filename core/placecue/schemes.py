"""Integration where cues are missing: a scheme for each set of cues."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from placecue.errors import ContractError, DataError, UnusableObservation
from placecue.evidence import Evidence
from placecue.folds import Rows
from placecue.guard import call
from placecue.held_out import HeldOut
from placecue.integration import integrated, unfitted
from placecue.integrator import Integrator
from placecue.observation import Observation
from placecue.ownership import provenance
from placecue.scores import Layout, Scores

#: Some of the cues, in the order of all.
Cues: TypeAlias = tuple[str, ...]
#: Up to so many cues there is a scheme for every set of them.
EVERY_SET = 4


class Schemes:
    """A fitted integrator for each set of cues.

    A sample is integrated by the scheme of the cues that it has, or else by that of the largest
    set among them. One cue alone needs no integrator: what it says is told in the layout of all.

    Parameters
    ----------
    by_cues : mapping of tuple of str to Integrator
        The integrators, that of all cues first; of one that copes with gaps itself no other.
    layout : Layout, optional
        That of the integrated scores, in which a cue alone is told.

    References
    ----------
    Our choice; Pronobis et al., IJRR 29(2-3), 2010, fit a scheme for each step of confidence-based
    integration likewise (section 4.3).
    """

    def __init__(self, by_cues: Mapping[Cues, Integrator], layout: Layout | None = None) -> None:
        self.by_cues = dict(by_cues)
        self.layout = layout

    @classmethod
    def fit(
        cls, integrator: Integrator, held_out: HeldOut, sets: Iterable[Cues] | None = None
    ) -> Schemes:
        """Fit an integrator on all cues, and copies of it on sets of them.

        Parameters
        ----------
        integrator : Integrator
            Becomes the scheme of all cues.
        held_out : HeldOut
            Evidence with gaps. Each scheme is fitted on the samples that have its cues.
        sets : iterable of tuple of str, optional
            Which sets there are to be schemes for; by default as :func:`sets_of` says, and that
            of all cues alone where ``held_out.whole``.

        Raises
        ------
        DataError
            If no sample has all cues, or none of some class.
        """
        cues = held_out.evidence.cues
        if integrator.gaps:
            call(integrator, "train", held_out)
            return cls({cues: integrator})
        having = _having(held_out, cues)
        call(integrator, "train", having)
        found = cls({cues: integrator}, _layout(integrator, having))
        if sets is None:
            sets = () if held_out.whole else sets_of(cues)
        for some in sets:
            if some not in found.by_cues and not found._tells(some, having):
                scheme = unfitted(integrator)
                call(scheme, "train", _having(held_out, some))
                found.by_cues[some] = scheme
        return found

    @property
    def full(self) -> Integrator:
        """The scheme of all cues."""
        return next(iter(self.by_cues.values()))

    def of(self, cues: Sequence[str]) -> Cues:
        """Return the largest set with a scheme among some cues, the first of equals; or none."""
        there = set(cues)
        alone = [(cue,) for cue in cues] if self._tells_one else []
        fitting = [some for some in [*self.by_cues, *alone] if there.issuperset(some)]
        return max(fitting, key=len, default=())

    @property
    def _tells_one(self) -> bool:
        """Whether a cue alone is told in the layout of all."""
        return self.layout is not None and not self.full.fits_alone

    def _tells(self, cues: Cues, having: HeldOut) -> bool:
        """Tell whether what some cues say can be told in the layout without an integrator."""
        if len(cues) > 1 or not self._tells_one:
            return False
        return self._told(having.evidence.take([0]), cues[0]) is not None

    def _told(self, evidence: Evidence, cue: str) -> Scores | None:
        """Return what a cue alone says in the layout of all; None where it cannot be told."""
        assert self.layout is not None  # or it would be fitted
        return evidence.scores(cue).told_in(self.layout)

    def join(self, evidence: Evidence) -> Scores:
        """Return the integrated scores of n observations that have all cues of the evidence.

        By the scheme of these cues, or else by that of the largest set among them.
        """
        cues = evidence.cues
        if self.full.gaps:
            joined: Scores = call(self.full, "integrate", evidence)
            return joined
        if cues not in self.by_cues:
            cues = self.of(cues)
            evidence = evidence.only(cues)
        if cues in self.by_cues:
            joined = call(self.by_cues[cues], "integrate", evidence)
            return joined
        told = self._told(evidence, cues[0])
        assert told is not None  # or an integrator was fitted for it
        return told

    def integrate(
        self,
        evidence: Evidence,
        observations: Sequence[Observation] | None = None,
        *,
        skip: bool = False,
    ) -> tuple[Scores, dict[int, UnusableObservation]]:
        """Return the integrated scores of n observations, and where an integrator failed.

        Parameters and results are those of :func:`placecue.integration.integrated`.
        """
        if self.full.gaps:
            return integrated(self.full, evidence, observations, skip=skip)
        scores: Scores | None = None
        failed: dict[int, UnusableObservation] = {}
        known, rows = evidence.known(), np.arange(len(evidence))
        while rows.size:
            for row in rows.tolist():  # asked about anew
                failed.pop(row, None)
            for cues, of_set in self._parted(evidence.cues, known, rows):
                found = None
                if cues:
                    some = None if observations is None else [observations[row] for row in of_set]
                    part = _part(evidence, cues, of_set)
                    found, wrong = self._integrated(cues, part, some, skip)
                    failed |= {int(of_set[row]): error for row, error in wrong.items()}
                    # Where it failed at every one there is nothing that has its layout.
                    found = None if len(wrong) == len(of_set) else found
                scores = self._placed(scores, found, of_set, len(evidence))
            # What was extracted may be unusable: such rows are asked about again, without it.
            before, known = known, evidence.known()
            rows = np.flatnonzero((known != before).any(axis=1))
        if scores is None:
            layout = evidence.layout(evidence.cues[0])
            scores = Scores(np.full((len(evidence), len(layout.columns)), np.nan), layout)
        return scores, failed

    def _integrated(
        self,
        cues: Cues,
        evidence: Evidence,
        observations: Sequence[Observation] | None,
        skip: bool,
    ) -> tuple[Scores | None, dict[int, UnusableObservation]]:
        if cues in self.by_cues:
            return integrated(self.by_cues[cues], evidence, observations, skip=skip)
        return self._told(evidence, cues[0]), {}

    def _parted(self, cues: Cues, known: NDArray[np.bool_], rows: Rows) -> list[tuple[Cues, Rows]]:
        """Return which rows are integrated by the scheme of which cues."""
        parts = []
        here = known[rows]
        alike = bool((here == here[0]).all())  # as nearly always
        for pattern in here[:1] if alike else np.unique(here, axis=0):
            there = [cue for cue, has in zip(cues, pattern, strict=True) if has]
            parts.append((self.of(there), rows[(here == pattern).all(axis=1)]))
        return parts

    def _placed(
        self, scores: Scores | None, found: Scores | None, rows: Rows, n: int
    ) -> Scores | None:
        """Return the scores with those found in place; NaN where nothing was."""
        if found is None:
            if scores is not None:
                scores.values[rows] = np.nan
            return scores
        if scores is None:
            return found.spread(rows, n)
        if scores.layout != found.layout:
            raise ContractError(
                f"{provenance(self.full)}: gives scores {scores.layout} for some cues and "
                f"{found.layout} for others: they must be of one layout"
            )
        scores.values[rows] = found.values
        return scores


def sets_of(cues: Sequence[str], together: Iterable[Cues] = ()) -> list[Cues]:
    """Return the sets of cues that schemes are fitted for, the larger first.

    Every set of up to :data:`EVERY_SET` cues; of more, all but one, each alone, and what is left
    where cues go missing together.

    Parameters
    ----------
    cues : sequence of str
        All cues.
    together : iterable of tuple of str
        Sets of which all cues may be there alone, such as those that do without an image.
    """
    n = len(cues)
    sizes = range(n, 0, -1) if n <= EVERY_SET else (n, n - 1, 1)
    found = [some for size in sizes for some in combinations(cues, size)]
    more = {tuple(cue for cue in cues if cue in some) for some in together}
    found += [some for some in more if some and some not in found]
    return sorted(found, key=len, reverse=True)


def _layout(integrator: Integrator, having: HeldOut) -> Layout:
    """Return the layout of a fitted integrator's scores."""
    return integrated(integrator, having.evidence.take([0]))[0].layout


def _having(held_out: HeldOut, cues: Cues) -> HeldOut:
    """Return the samples that have all of some cues."""
    having = held_out.having(cues)
    lacking = sorted(set(held_out.labels.tolist()) - set(having.labels.tolist()))
    if lacking:
        of_class = "" if not len(having) else f" of {' or '.join(map(repr, lacking))}"
        raise DataError(
            f"no sample{of_class} has scores of all cues ({', '.join(cues)}): an integrator "
            "learns from samples that do; give a log in which they are there together"
        )
    return having


def _part(evidence: Evidence, cues: Cues, rows: Rows) -> Evidence:
    """Return some of the cues of some observations; all of them as they are."""
    part = evidence if cues == evidence.cues else evidence.only(cues)
    return part if len(rows) == len(evidence) else part.take(rows)
