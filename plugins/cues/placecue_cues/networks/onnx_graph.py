"""Writes ONNX files, field by field as onnx.proto numbers them, without the onnx package.

That package has 18 MB and brings protobuf and ml_dtypes; a network of convolutions needs what
stands here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .protobuf import data, number, real, text

Attribute: TypeAlias = int | float | str | Sequence[int]
#: A size, or the name of one that is left open.
Size: TypeAlias = int | str

IR_VERSION = 8
OPSET = 13
_TYPES = {np.dtype(np.float32): 1, np.dtype(np.int64): 7}


class Graph:
    """A network in the making: nodes are added in the order in which they are run.

    Parameters
    ----------
    name : str
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self._nodes: list[bytes] = []
        self._tensors: list[bytes] = []
        self._inputs: list[bytes] = []
        self._outputs: list[bytes] = []

    def input(self, name: str, *shape: Size) -> str:
        """Add an input of float32 and return its name."""
        self._inputs.append(_value(name, shape))
        return name

    def output(self, name: str, *shape: Size) -> None:
        """Make the result of a node an output."""
        self._outputs.append(_value(name, shape))

    def tensor(self, name: str, values: NDArray[Any]) -> str:
        """Add a constant of float32 or int64 and return its name."""
        dims = b"".join(number(1, size) for size in values.shape)
        kind = _TYPES[values.dtype]
        raw = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<"), copy=False)
        self._tensors.append(dims + number(2, kind) + text(8, name) + data(9, raw.tobytes()))
        return name

    def node(self, kind: str, inputs: Sequence[str], output: str, **attributes: Attribute) -> str:
        """Add a node of an operator and return the name of its result."""
        made = b"".join(text(1, each) for each in inputs) + text(2, output)
        made += text(3, output) + text(4, kind)
        made += b"".join(data(5, each) for each in _attributes(attributes))
        self._nodes.append(made)
        return output

    def model(self) -> bytes:
        """Return the ONNX file."""
        graph = b"".join(data(1, each) for each in self._nodes) + text(2, self.name)
        for field, messages in ((5, self._tensors), (11, self._inputs), (12, self._outputs)):
            graph += b"".join(data(field, each) for each in messages)
        opset = text(1, "") + number(2, OPSET)
        head = number(1, IR_VERSION) + text(2, "placecue")
        return head + data(7, graph) + data(8, opset)


def _attributes(attributes: Mapping[str, Attribute]) -> list[bytes]:
    made = []
    for name, value in attributes.items():
        if isinstance(value, str):
            made.append(text(1, name) + data(4, value.encode()) + number(20, 3))
        elif isinstance(value, float):
            made.append(text(1, name) + real(2, value) + number(20, 1))
        elif isinstance(value, int):
            made.append(text(1, name) + number(3, value) + number(20, 2))
        else:
            every = b"".join(number(8, each) for each in value)
            made.append(text(1, name) + every + number(20, 7))
    return made


def _value(name: str, shape: Sequence[Size]) -> bytes:
    """Return what a graph says of an input or output of float32."""
    sizes = (number(1, each) if isinstance(each, int) else text(2, each) for each in shape)
    dims = b"".join(data(1, each) for each in sizes)
    tensor = number(1, 1) + data(2, dims)
    return text(1, name) + data(2, data(1, tensor))
