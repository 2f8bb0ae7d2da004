"""The choice of a few among very many wrong decisions, spread over classes, pairs and methods."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from placecue.evaluation.results.result import Pair, Result


class WrongDecisions:
    """Wrong decisions by class, pair and method, the surest first.

    Parameters
    ----------
    of_pair : mapping of Pair to sequence of Result
        What all methods say of each pair.

    Attributes
    ----------
    total : int
        Wrong decisions.
    samples : int
        Samples that one method or more decided wrongly on.
    """

    def __init__(self, of_pair: Mapping[Pair, Sequence[Result]]) -> None:
        self._of: dict[str, dict[Pair, dict[str, list[int]]]] = {}
        self.total = self.samples = 0
        for pair, results in of_pair.items():
            self.samples += len(self._filled(pair, results))
        self._of = dict(sorted(self._of.items()))

    def _filled(self, pair: Pair, results: Iterable[Result]) -> set[int]:
        met: set[int] = set()
        for result in results:
            wrong = np.flatnonzero(result.decided != result.truth)
            sure = np.nan_to_num(result.confidence[wrong], nan=-np.inf)
            wrong = wrong[np.lexsort((result.stamps[wrong], -sure))]
            self.total += len(wrong)
            met.update(result.stamps[wrong].tolist())
            for number in np.unique(result.truth[wrong]):
                stamps = result.stamps[wrong[result.truth[wrong] == number]]
                of_class = self._of.setdefault(result.classes[number], {})
                of_class.setdefault(pair, {})[result.method] = stamps.tolist()
        return met

    def chosen(self, most: int) -> list[tuple[Pair, str, int]]:
        """Return pair, method and stamp of so many samples; what was not chosen is let go."""
        found: dict[tuple[Pair, int], str] = {}
        taken: Counter[object] = Counter()
        while self._of and len(found) < most:
            for name in list(self._of):
                if len(found) < most and not self._one_of(name, found, taken):
                    del self._of[name]
        return [(pair, method, stamp) for (pair, stamp), method in found.items()]

    def _one_of(
        self, name: str, found: dict[tuple[Pair, int], str], taken: Counter[object]
    ) -> bool:
        """Take one more of a class; return whether there was one."""
        pairs = self._of[name]
        while pairs:
            pair = min(pairs, key=lambda each: (taken[name, each], taken[each]))
            method = min(pairs[pair], key=lambda each: taken[each])
            stamps = pairs[pair][method]
            stamp = next((each for each in stamps if (pair, each) not in found), None)
            if stamp is not None:
                found[pair, stamp] = method
                taken.update([(name, pair), pair, method])
                return True
            del pairs[pair][method]
            if not pairs[pair]:
                del pairs[pair]
        return False
