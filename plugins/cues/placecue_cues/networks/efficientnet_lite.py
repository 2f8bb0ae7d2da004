"""EfficientNet-Lite as an ONNX graph, from the tensors of its state dict.

Widths, depths, kernels and expansions are those of the tensors; the strides are the architecture's.
Batch norms are folded into the convolutions before them.

References
----------
Tan and Le, EfficientNet: rethinking model scaling for convolutional neural networks, ICML 2019;
the Lite variants have no squeeze-and-excitation, and ReLU6 for swish.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .onnx_graph import Graph

Tensors = Mapping[str, NDArray[Any]]

#: Stride of the first block of each stage.
STRIDES = (1, 2, 2, 2, 1, 2, 1)
EPSILON = 1e-3


@dataclass
class _Writer:
    """Adds layers to a graph, one after the other."""

    graph: Graph
    tensors: Tensors
    name: str
    side: int
    channels: int = 3

    def convolution(self, layer: str, norm: str, stride: int = 1, clipped: bool = True) -> None:
        """Add a convolution with "same" padding, its batch norm and, mostly, ReLU6."""
        weight, bias = folded(self.tensors, layer, norm)
        kernel, after = weight.shape[2], -(-self.side // stride)
        padding = max((after - 1) * stride + kernel - self.side, 0)
        before = padding // 2  # TensorFlow puts the odd pixel at the end
        inputs = [self.name, self.graph.tensor(f"{layer}.weight", weight)]
        self.name = self.graph.node(
            "Conv",
            [*inputs, self.graph.tensor(f"{layer}.bias", bias)],
            layer,
            kernel_shape=[kernel, kernel],
            strides=[stride, stride],
            pads=[before, before, padding - before, padding - before],
            # One channel in for each out: every channel by itself.
            group=len(weight) if "depthwise" in layer else 1,
        )
        self.side, self.channels = after, len(weight)
        if clipped:
            self.name = self.graph.node("Clip", [self.name, "zero", "six"], f"{layer}.relu6")

    def block(self, number: int, stride: int) -> None:
        """Add an inverted residual block."""
        into, channels, block = self.name, self.channels, f"_blocks.{number}"
        if f"{block}._expand_conv.weight" in self.tensors:
            self.convolution(f"{block}._expand_conv", f"{block}._bn0")
        self.convolution(f"{block}._depthwise_conv", f"{block}._bn1", stride)
        self.convolution(f"{block}._project_conv", f"{block}._bn2", clipped=False)
        if stride == 1 and channels == self.channels:
            self.name = self.graph.node("Add", [into, self.name], f"{block}.sum")


def efficientnet_lite(tensors: Tensors, side: int, repeats: tuple[int, ...]) -> bytes:
    """Return the network as an ONNX file.

    Parameters
    ----------
    tensors : mapping of str to ndarray
        Of the state dict.
    side : int
        Of the square picture that goes in, pixels.
    repeats : tuple of 7 int
        How many blocks each stage has.

    Returns
    -------
    bytes
        Of a network from ``image`` (n, 3, side, side) to ``embedding`` (n, 1280) and ``logits``
        (n, 1000).
    """
    graph = Graph("efficientnet_lite")
    writer = _Writer(graph, tensors, graph.input("image", "n", 3, side, side), side)
    graph.tensor("zero", np.array(0, dtype=np.float32))
    graph.tensor("six", np.array(6, dtype=np.float32))
    writer.convolution("_conv_stem", "_bn0", 2)
    number = 0
    for stride, count in zip(STRIDES, repeats, strict=True):
        for repeat in range(count):
            writer.block(number, stride if repeat == 0 else 1)
            number += 1
    writer.convolution("_conv_head", "_bn1")
    pooled = graph.node("GlobalAveragePool", [writer.name], "pooled")
    graph.node("Flatten", [pooled], "embedding", axis=1)
    weights = [graph.tensor(f"_fc.{each}", tensors[f"_fc.{each}"]) for each in ("weight", "bias")]
    graph.node("Gemm", ["embedding", *weights], "logits", transB=1)
    width, classes = tensors["_fc.weight"].shape[::-1]
    graph.output("embedding", "n", int(width))
    graph.output("logits", "n", int(classes))
    return graph.model()


def folded(
    tensors: Tensors, layer: str, norm: str
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the weight and bias of a convolution with the batch norm after it."""
    weight = tensors[f"{layer}.weight"].astype(np.float64)
    scale, shift, mean, variance = (
        tensors[f"{norm}.{each}"].astype(np.float64)
        for each in ("weight", "bias", "running_mean", "running_var")
    )
    factor = scale / np.sqrt(variance + EPSILON)
    bias = shift - mean * factor
    return (weight * factor[:, None, None, None]).astype(np.float32), bias.astype(np.float32)
