"""Tiny networks whose numbers can be worked out by hand, as ONNX files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from placecue_cues.networks.onnx_graph import Graph
from placecue_cues.networks.protobuf import data, number, text

#: What the two channels make of red, green and blue, and what is added.
WEIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, -2.0]], np.float32)
BIAS = np.array([0.0, 10.0], np.float32)


def tiny(path: Path, side: int | str = 2, bias: float = 0.0) -> Path:
    """Write a network of a 1x1 convolution: ``map`` (n, 2, side, side) and ``mean`` (n, 2)."""
    graph = Graph("tiny")
    height, width = (side, side) if isinstance(side, int) else ("h", "w")
    image = graph.input("image", "n", 3, height, width)
    weights = graph.tensor("weight", WEIGHT[:, :, None, None])
    graph.node("Conv", [image, weights, graph.tensor("bias", BIAS + np.float32(bias))], "map")
    graph.node("GlobalAveragePool", ["map"], "pooled")
    graph.node("Flatten", ["pooled"], "mean", axis=1)
    graph.output("map", "n", 2, height, width)
    graph.output("mean", "n", 2)
    path.write_bytes(graph.model())
    return path


def of_bytes(path: Path) -> Path:
    """Write a network that gives back the bytes of an image of 2x2 pixels."""
    # Of its input and output: the kind of number, 1 for float32 and 2 for uint8, and the shape.
    made = of_one_node(path, "Identity").read_bytes()
    path.write_bytes(made.replace(b"\x08\x01\x12", b"\x08\x02\x12"))
    return path


def with_weights_elsewhere(path: Path) -> Path:
    """Write a network that adds to an image what stands in a file ``weights`` beside it."""
    path.with_name("weights").write_bytes(np.ones((1, 3, 1, 1), np.float32).tobytes())
    graph = Graph("elsewhere")
    graph.input("image", "n", 3, 2, 2)
    dims = b"".join(number(1, size) for size in (1, 3, 1, 1))
    where = data(13, text(1, "location") + text(2, "weights")) + number(14, 1)
    graph._tensors.append(dims + number(2, 1) + text(8, "weight") + where)
    graph.node("Add", ["image", "weight"], "out")
    graph.output("out", "n", 3, 2, 2)
    path.write_bytes(graph.model())
    return path


def of_one_node(path: Path, kind: str) -> Path:
    """Write a network of one operator from an image of 2x2 pixels to one."""
    graph = Graph("one")
    graph.node(kind, [graph.input("image", "n", 3, 2, 2)], "out")
    graph.output("out", "n", 3, 2, 2)
    path.write_bytes(graph.model())
    return path
