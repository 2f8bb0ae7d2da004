"""Evidence that counts which cues are asked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.evidence import StoredEvidence
from placecue.scores import Layout, Scores


class CountedEvidence(StoredEvidence):
    """Stored evidence that notes for which of the n samples each cue is asked.

    Views of it note what is asked of them in the same place.

    Parameters
    ----------
    stored : StoredEvidence

    Attributes
    ----------
    asked : dict of str to ndarray of bool, shape (n,)
    """

    def __init__(self, stored: StoredEvidence) -> None:
        super().__init__({cue: stored.scores(cue) for cue in stored.cues})
        self.asked = {cue: np.zeros(len(self), dtype=bool) for cue in self.cues}
        self._rows = np.arange(len(self))

    def scores(self, cue: str) -> Scores:
        """Return the scores of a cue, and note that it was asked."""
        found = super().scores(cue)
        self.asked[cue][self._rows] |= found.available()
        return found

    def layout(self, cue: str) -> Layout:
        """Return the layout of a cue; that is not asking it."""
        return self._scores[cue].layout

    def available(self, cue: str) -> NDArray[np.bool_]:
        """Return where a cue is there; that is not asking it."""
        return self._scores[cue].available()

    def take(self, rows: Any) -> CountedEvidence:
        """Return some of the samples."""
        some = np.arange(len(self))[np.asarray(rows)] if len(rows) else np.empty(0, np.int64)
        return self._like({cue: self._scores[cue][some] for cue in self.cues}, some)

    def only(self, cues: Sequence[str]) -> CountedEvidence:
        """Return some of the cues."""
        return self._like({cue: self._scores[cue] for cue in cues}, np.arange(len(self)))

    def _like(self, scores: dict[str, Scores], some: NDArray[np.int64]) -> CountedEvidence:
        made = CountedEvidence.__new__(CountedEvidence)
        StoredEvidence.__init__(made, scores)
        made.asked, made._rows = self.asked, self._rows[some]
        return made
