"""Learns from labelled logs which places lie beside one another, for the accumulators hmm and crf.

    python examples/learn_neighbours.py MODEL LOG.mcap [LOG.mcap ...] FOLDER

writes FOLDER/transitions.json and FOLDER/weights.json, to be given as

    placecue label MODEL run.mcap accumulator=hmm accumulator.transitions=FOLDER/transitions.json
    placecue label MODEL run.mcap accumulator.weights=FOLDER/weights.json

The model must not have been trained on these logs, else it seems better than it is.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from placecue.components.manager import load_plugins
from placecue.evaluation.area_scores import AreaTally
from placecue.logs import open_log
from placecue.pipeline import Pipeline
from placecue.storage.model import load_model
from placecue_accumulators.crf import RandomField
from placecue_accumulators.neighbours import learned_field, steps_between


def main(model: str, logs: Sequence[str], out: str) -> None:
    """Learn from some logs, and write both files."""
    pipeline = load_model(Path(model), load_plugins().registry)
    classes, folder = list(pipeline.classes), Path(out)
    order, unary, edges, truth = [], [], [], []
    for log in logs:
        visited, labels, likelihoods, beside = _driven(pipeline, log)
        known = {node: row for row, node in enumerate(labels)}  # nodes whose class is known
        order += [labels[node] for node in visited if node in known]
        edges += [
            (known[a] + len(truth), known[b] + len(truth))
            for a, b in beside
            if a in known and b in known
        ]
        unary += [likelihoods[node] for node in known]
        truth += [classes.index(label) for label in labels.values()]
    folder.mkdir(parents=True, exist_ok=True)
    steps_between(order, classes).write(folder / "transitions.json")
    field = learned_field(np.array(unary), edges, np.array(truth), classes)
    field.write(folder / "weights.json")


def _driven(
    pipeline: Pipeline, log: str
) -> tuple[list[int], dict[int, str], np.ndarray, list[tuple[int, int]]]:
    """Return the nodes in the order of the drive, their true classes, and what was seen there."""
    nodes, tally, visited = RandomField(), AreaTally(), []
    for seen, belief in pipeline.follow(open_log(log)):
        tally.observe(seen, belief, nodes.update(seen, belief))
        at = nodes.graph_.current
        if at is not None and visited[-1:] != [at]:
            visited.append(at)
    found = tally.truth(nodes.semantic_map())[1]
    most = {node: of.most_common(1)[0][0] for node, of in sorted(found.items())}
    return visited, {n: c for n, c in most.items() if c in pipeline.classes}, *nodes.evidence()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:-1], sys.argv[-1])
