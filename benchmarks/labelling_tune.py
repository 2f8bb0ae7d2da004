"""Chooses the boundaries and the few numbers of labelling on the tuning half.

    PLACECUE_DATA=data python benchmarks/labelling_tune.py runs/labelling

One criterion: the share of the way that is labelled rightly, the mean of the drives on simulated
floors and the mean of the drives through plans, averaged. Only the two numbers that say how sure
many beliefs make us (independent, doubt) are chosen by the log loss of areas and nodes instead,
the mean over tests. Numbers are searched one after the other, each from what was best before; the
first of each list stays unless another is better after rounding to a tenth of a point (a log loss
of 0.001). What counts as an unsure belief (accept_confidence) is the paper's, and is not searched.
How much less is told in another building (temperature) comes last, by the log loss too, the mean
over groups of tests; two of them are stranger than what all else was chosen on: plans
that are fuller than any seen, and another building with a camera. What was computed is kept in the
folder. The accumulator that is shipped is the best by the criterion, unless it says less on the way
(live).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import mean

from labelling_data import Data
from labelling_outcomes import Outcome, Outcomes, log_loss
from labelling_page import GROUPS
from labelling_plan import Test, tests

#: Whose boundaries are searched.
PAPER = "accumulator=spatiotemporal"
BOUNDARY = "boundaries@accumulator.boundary"
EVIDENCE = "accumulator.boundary.evidence"
COMBINATIONS = [
    "door_noisy,evidence",
    "none",
    "node",
    "door",
    "door_noisy",
    "evidence",
    "door,evidence",
    "node,evidence",
    "door_noisy,node",
]
#: One after the other, of what is chosen by the way.
NUMBERS = {
    f"{EVIDENCE}.rejoin": [3.0, 1.0, 0.3, 0.0],
    f"{EVIDENCE}.threshold": [3.0, 1.5, 2.0, 4.0, 6.0],
    f"{EVIDENCE}.independent": [0.4, 0.1, 0.2, 0.7],
    f"{EVIDENCE}.doubt": [0.1, 0.02, 0.2],
    f"{EVIDENCE}.window": [6.0, 4.0, 10.0],
    f"{EVIDENCE}.shortest": [0.8, 0.4, 1.6],
    "accumulator.gateway_spacing": [1.0, 2.0],
}
#: By the log loss.
SURENESS = {
    "accumulator.independent": [0.1, 0.0, 0.01, 0.03, 0.3, 1.0],
    "accumulator.doubt": [0.02, 0.005, 0.05, 0.1, 0.2],
}
#: By the log loss of groups: with the factors that are shipped (MOST and ALONE of the accumulators'
#: strangeness.py) log odds of the drawn building are divided by 3 times this, of plans by 2 times.
STRANGENESS = {"accumulator.temperature": [1.0, 0.333, 0.5, 0.75, 1.333, 2.0]}
OTHERS = {
    "hmm": {"accumulator.lasts": [8.0, 2.0, 4.0, 16.0]},
    "crf": {"accumulator.same": [2.0, 0.5, 1.0, 3.0]},
    "relaxation": {"accumulator.support": [0.6, 0.3, 0.9], "accumulator.rounds": [10, 3, 30]},
}


def way(found: Sequence[Outcome], of: str = "way") -> float:
    """Return the criterion, or another share likewise."""
    floors = [each[of] for each in found if each["test"].startswith("floor")]
    drives = [each[of] for each in found if not each["test"].startswith("floor")]
    return mean([mean(floors), mean(drives)])


def loss(found: Sequence[Outcome]) -> float:
    """Return the log loss of areas and nodes, negative."""
    said = ("areas_said", "nodes_said")
    return -mean(log_loss(each[part]) for each in found for part in said if each[part])


def loss_of_groups(found: Sequence[Outcome]) -> float:
    """Return the log loss of areas and nodes, negative, the mean over groups of tests."""
    by_name = {each["test"]: each for each in found}
    losses = {}
    for name, belongs in GROUPS.items():
        group = [by_name[t.name] for t in tests() if belongs(t) and t.name in by_name]
        if group:
            losses[name] = loss(group)
    print("  log loss:", ", ".join(f"{name} {-each:.3f}" for name, each in losses.items()))
    return mean(losses.values())


def is_strange(test: Test) -> bool:
    """Tell whether a test is stranger than what settings but the temperature were chosen on."""
    return test.name.startswith("drawn") or test.name.endswith("strange")


class Search:
    """Tries words on the tuning half and tells of each.

    Parameters
    ----------
    outcomes : Outcomes
    """

    def __init__(self, outcomes: Outcomes) -> None:
        self.outcomes = outcomes
        self.every = [test for test in tests() if test.half == "tuning"]
        self.tests = [test for test in self.every if not is_strange(test)]

    def worth(self, words: Sequence[str]) -> float:
        """Return the criterion of some words."""
        return way(self.outcomes.of(words, self.tests))

    def best(
        self,
        words: Sequence[str],
        key: str,
        values: Sequence[object],
        criterion: Callable[[Sequence[Outcome]], float] = way,
        tests: Sequence[Test] | None = None,
    ) -> list[str]:
        """Return the words with the best value of a key; the first of equals."""
        tried = []
        for value in values:
            shipped = key.startswith("accumulator.") and EVIDENCE not in key and value == values[0]
            given = [*words] if shipped else [*words, f"{key}={value}"]
            found = self.outcomes.of(given, self.tests if tests is None else tests)
            tried.append((criterion(found), given))
            print(
                f"{way(found):.4f} live {way(found, 'live'):.4f} loss {-loss(found):.3f} unknown "
                f"{mean(each['unknown'] for each in found):.3f}  {' '.join(given)}",
                flush=True,
            )
        return max(tried, key=lambda each: round(each[0], 3))[1]


def _fitting(combination: str, numbers: Sequence[str]) -> list[str]:
    """Return the words that a combination of boundaries has a use for."""
    return [each for each in numbers if "evidence" in combination or EVIDENCE not in each]


def main(folder: Path) -> None:
    """Search, and print every step."""
    search = Search(Outcomes(folder / "tuning.jsonl", Data(folder)))
    words = search.best([PAPER], BOUNDARY, [f"[{each}]" for each in COMBINATIONS])
    if "evidence" not in words[1]:  # it has numbers of its own, which it may do better with
        words = search.best([PAPER], BOUNDARY, [f"[{COMBINATIONS[0]}]"])
    for key, values in NUMBERS.items():
        words = search.best(words, key, values)
    numbers = words[2:]
    again = [
        search.best([PAPER, *_fitting(each, numbers)], BOUNDARY, [f"[{each}]"])
        for each in COMBINATIONS
    ]
    words = max(again, key=lambda each: round(search.worth(each), 3))
    for key, values in SURENESS.items():
        words = search.best(words, key, values, loss)
    print("chosen:", *words)
    sure = [word for word in words if word.split("=")[0] in SURENESS]
    for name, numbers in OTHERS.items():
        words = [f"accumulator={name}", *sure]
        for key, values in numbers.items():
            words = search.best(words, key, values)
        words = search.best(words, BOUNDARY, ["[door_noisy]", "[]"])
        print("chosen:", *words)
    for key, values in STRANGENESS.items():
        print("chosen:", *search.best([], key, values, loss_of_groups, search.every))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
