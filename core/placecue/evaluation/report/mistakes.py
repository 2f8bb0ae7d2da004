"""Mistakes: which of very many are shown, and what each shows."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from placecue.evaluation.report.pictured import Pictured
from placecue.evaluation.report.wrong_decisions import WrongDecisions
from placecue.evaluation.results.about import About, Method
from placecue.evaluation.results.result import Pair, Result
from placecue.evaluation.results.results import Results

#: Samples that are looked at; the bytes of the page may be used up before.
MOST = 600
#: What a mistake takes on a page besides its picture, its drawing and its names, bytes.
FRAME = 1500


class Bar(NamedTuple):
    """A score, as a bar.

    Parameters
    ----------
    name : str
        Whose: a class, or a cue with what it decided.
    value : float
        The score.
    share : float
        Length of the bar, 0 to 1.
    right : bool
        Whether it is that of the true class.
    """

    name: str
    value: float
    share: float
    right: bool


class Scored(NamedTuple):
    """The bars of one cue, or of one kind.

    Parameters
    ----------
    title : str
        The cue.
    bars : tuple of Bar
        Its scores.
    """

    title: str
    bars: tuple[Bar, ...]


@dataclass(frozen=True)
class Mistake(Pictured):
    """A sample that was taken for another class.

    Parameters
    ----------
    recording : str
        Where it is from.
    stamp : int
        When, ns.
    truth, decided : str
        What it is, and what it was taken for; empty where nothing was decided.
    confidence : float
        Of the decision; NaN where there is none.
    method : str
        Whose decision that is.
    pair : str
        What was trained and tested on; empty outside an evaluation.
    said : mapping of str to sequence of str
        What all methods decided: class, and the methods that decided so.
    scores : sequence of Scored
        Those of the cues.
    image : bytes
        A small JPEG; empty where there is none.
    scan : ndarray of float64, shape (k, 2), or None
        Where the laser hit, in the robot's frame, m.
    """

    recording: str
    stamp: int
    truth: str
    decided: str
    confidence: float
    method: str
    pair: str = ""
    said: Mapping[str, Sequence[str]] = field(default_factory=dict)
    scores: Sequence[Scored] = ()
    image: bytes = b""
    scan: NDArray[np.float64] | None = None

    @property
    def right(self) -> Sequence[str]:
        """The methods that decided rightly."""
        return self.said.get(self.truth, ())

    @property
    def wrong(self) -> list[str]:
        """The methods that did not."""
        return [name for decided, names in self.said.items() if decided != self.truth
                for name in names]  # fmt: skip

    @property
    def seconds(self) -> str:
        """The stamp, s."""
        return f"{self.stamp // 10**9}.{self.stamp % 10**9:09d}"[:-6]

    @property
    def size(self) -> int:
        """About how many bytes it takes on a page."""
        names = sum(len(name.encode()) for each in self.said.values() for name in each)
        drawing = len(self.drawing.path) if self.drawing else 0
        return len(self.image) * 4 // 3 + drawing + 2 * names + FRAME


@dataclass(frozen=True)
class Mistakes:
    """Mistakes on a page, with what their reader can choose by.

    Parameters
    ----------
    shown : sequence of Mistake
        Those on the page.
    total : int
        How many wrong decisions there are.
    samples : int
        Of how many samples; 0 where that is not known.
    notes : sequence of str
        What is missing, and why.
    """

    template: ClassVar[str] = "mistakes.html.j2"

    shown: Sequence[Mistake]
    total: int
    samples: int = 0
    notes: Sequence[str] = ()

    @property
    def classes(self) -> list[str]:
        """True classes to choose from."""
        return sorted({each.truth for each in self.shown})

    @property
    def pairs(self) -> list[str]:
        """Pairs to choose from."""
        return list(dict.fromkeys(sorted(each.pair for each in self.shown if each.pair)))

    @property
    def methods(self) -> list[str]:
        """Methods to choose from."""
        return list(dict.fromkeys(name for each in self.shown for name in each.wrong))

    def within(self, budget: int) -> Mistakes:
        """Return as many of them, from the first on, as take no more bytes than that."""
        ends = np.cumsum([each.size for each in self.shown])
        kept = self.shown[: int(np.searchsorted(ends, budget, side="right"))]
        return Mistakes(kept, self.total, self.samples, self.notes)


def find_mistakes(
    results: Results, methods: Mapping[str, Method] | None = None, most: int = MOST
) -> Mistakes:
    """Choose mistakes of an experiment, spread over classes, pairs and methods.

    Classes take turns; of a class comes the pair, and of that the method, of which fewest were
    chosen so far, and of that the decision that was made with the highest confidence. No chance
    is in it. A sample is chosen once, and tells what all methods say of it.

    Parameters
    ----------
    results : Results
        Of all methods and pairs.
    methods : mapping of str to Method, optional
        Tells the single-cue models, whose confidence is shown as bars.
    most : int
        So many samples at most.

    Returns
    -------
    Mistakes
        In the order in which they were chosen, so that those from the first on are spread too.
    """
    of_pair = _by_pair(results)
    wrong = WrongDecisions(of_pair)
    alone = {name for name, each in (methods or {}).items() if len(each.cues) == 1}
    shown = [_mistake(of_pair[pair], method, stamp, alone)
             for pair, method, stamp in wrong.chosen(most)]  # fmt: skip
    return Mistakes(shown, wrong.total, wrong.samples)


def recording_of(pair: Pair, about: About) -> str:
    """Return the name of the recording that a pair is tested on."""
    inside = f"{pair.world}/{pair.test}"
    return inside if inside in about.recordings else pair.test


def _by_pair(results: Results) -> dict[Pair, list[Result]]:
    of_pair: dict[Pair, list[Result]] = defaultdict(list)
    for result in results.of():
        of_pair[result.pair].append(result)
    return dict(of_pair)


def _mistake(results: Sequence[Result], method: str, stamp: int, alone: set[str]) -> Mistake:
    said: dict[str, list[str]] = defaultdict(list)
    bars = []
    truth, decided, confidence = "", "", float("nan")
    for result in results:
        at = np.flatnonzero(result.stamps == stamp)
        if not len(at):
            continue
        here, name = int(at[0]), _decided(result, int(at[0]))
        said[name].append(result.method)
        if result.method == method:
            truth = result.classes[result.truth[here]]
            decided, confidence = name, float(result.confidence[here])
        if result.method in alone:
            bars.append(_bar(result, here, name))
    scores = [Scored("confidence of each cue alone", tuple(bars))] if bars else []
    pair = results[0].pair
    return Mistake(pair.test, stamp, truth, decided, confidence, method, str(pair), said, scores)


def _decided(result: Result, at: int) -> str:
    return result.classes[result.decided[at]] if result.decided[at] >= 0 else ""


def _bar(result: Result, at: int, decided: str) -> Bar:
    value = float(result.confidence[at])
    largest = float(np.nanmax(np.abs(result.confidence), initial=0))
    share = abs(value) / largest if largest > 0 and value == value else 0.0
    right = bool(result.decided[at] == result.truth[at])
    return Bar(f"{result.method}: {decided or 'nothing'}", value, share, right)
