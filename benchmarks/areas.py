"""Areas of labelled logs by each boundary and accumulator: how much of the way is labelled rightly.

    python benchmarks/areas.py MODEL LOG [MODEL LOG ...]

Positions are counted once a bin of 0.2 m. An area is right where its label is that of most of its
positions. The default boundary was chosen on ``idol2_floor`` with seeds 3 and 4 (the second run of
each, by models of the first run of the same and of the other); demo and ``second_floor`` are what
is reported.
"""

from __future__ import annotations

import sys
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np

from placecue import Accumulator, Belief, Observation, SemanticMap
from placecue.components.manager import load_plugins
from placecue.logs import open_log
from placecue.storage.model import load_model
from placecue_accumulators.crf import RandomField
from placecue_accumulators.door import Door
from placecue_accumulators.evidence import ChangedEvidence
from placecue_accumulators.hmm import HiddenMarkov
from placecue_accumulators.never import Never
from placecue_accumulators.node import NodeLeft
from placecue_accumulators.relaxation import Relaxation
from placecue_accumulators.spatiotemporal import SpatioTemporal

Moments = list[tuple[Observation, Belief | None]]


def accumulators() -> dict[str, Accumulator]:
    """Return what is compared, by name."""
    noisy = Door(post_bearing=30.0, max_gap=0.05)
    boundaries = {
        "never": Never(),
        "node": NodeLeft(),
        "door": Door(),
        "door_noisy": noisy,
        "evidence": ChangedEvidence(),
        "door + evidence": [Door(), ChangedEvidence()],
        "door_noisy + node": [noisy, NodeLeft()],
        "door_noisy + evidence": [noisy, ChangedEvidence()],
    }
    settings = {"gateway_spacing": 1.0, "merge": "open"}
    return {
        **{name: SpatioTemporal(each, **settings) for name, each in boundaries.items()},
        "hmm": HiddenMarkov(),
        "crf": RandomField(),
        "relaxation": Relaxation(),
    }


def moments(model: str, log: str) -> Moments:
    """Return a log's moments without their images, and what the model says of each."""
    pipeline = load_model(Path(model), load_plugins().registry, "refuse")
    return [
        (Observation(o.stamp, pose=o.pose, scan=o.scan, label=o.label), belief)
        for o, belief in pipeline.follow(open_log(log), 16)
    ]


def judged(made: SemanticMap, log: Moments) -> tuple[float, float, int, int]:
    """Return the shares of the way that are right and unknown, areas that are right, and areas."""
    nodes = [node for node in made.nodes if not node.gateway]
    at = np.array([(node.x, node.y) for node in nodes])
    true: dict[int, Counter[str]] = defaultdict(Counter)
    bins = set()
    for seen, _ in log:
        if seen.pose is None or seen.label is None:
            continue
        key = (round(seen.pose.x / 0.2), round(seen.pose.y / 0.2), seen.label)
        if key not in bins:
            bins.add(key)
            nearest = int(np.hypot(*(at - [seen.pose.x, seen.pose.y]).T).argmin())
            true[nodes[nearest].area][seen.label] += 1
    labels = {area.id: area.label for area in made.areas}
    right = sum(count[labels[area]] for area, count in true.items())
    unknown = sum(count.total() for area, count in true.items() if labels[area] == "unknown")
    good = sum(labels[area] == count.most_common(1)[0][0] for area, count in true.items())
    return right / len(bins), unknown / len(bins), good, len(true)


def main(words: list[str]) -> None:
    """Print a table for each log."""
    for model, log in zip(words[::2], words[1::2], strict=True):
        read = moments(model, log)
        single = [b.label == o.label for o, b in read if b is not None and o.label is not None]
        print(f"\n{log} by {model}: {100 * np.mean(single):.1f} % of single samples right\n")
        print("| | way right (%) | unknown (%) | areas right |\n|---|---|---|---|")
        for name, accumulator in accumulators().items():
            for seen, belief in read:
                accumulator.update(seen, belief)
            right, unknown, good, areas = judged(accumulator.semantic_map(), read)
            print(f"| {name} | {100 * right:.1f} | {100 * unknown:.1f} | {good} of {areas} |")


if __name__ == "__main__":
    main(sys.argv[1:])
