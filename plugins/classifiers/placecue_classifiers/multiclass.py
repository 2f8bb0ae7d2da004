"""The multi-class extensions of binary machines: which to train, and how their outputs decide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.scores import Layout, ModifiedOneAgainstAll, OneAgainstAll, OneAgainstOne
from placecue_classifiers.machines import (
    Codes,
    Machines,
    Matrix,
    Weights,
    one_against_all,
    one_against_one,
    one_against_one_at,
)

LAYOUTS: dict[str, type[Layout]] = {
    "oao": OneAgainstOne,
    "oaa": OneAgainstAll,
    "modified_oaa": ModifiedOneAgainstAll,
}


@dataclass(frozen=True)
class Multiclass:
    """A multi-class extension with the cost and weights of its machines.

    Parameters
    ----------
    name : {"oao", "oaa", "modified_oaa"}
    classes : tuple of str
        The M classes.
    C : float
        Cost of a margin violation.
    weights : "balanced", ndarray of float64 of shape (M,), or None
        Weights of classes; see :func:`one_against_all`.
    """

    name: str
    classes: tuple[str, ...]
    C: float
    weights: Weights

    @property
    def layout(self) -> Layout:
        """What the columns of the machines' outputs are."""
        return LAYOUTS[self.name](self.classes)

    @property
    def same(self) -> tuple[Any, ...]:
        """What :meth:`trained` depends on but C: both kinds of one-against-all agree in it."""
        return self.name == "oao", str(self.weights)

    def machines(self, gram: Matrix, codes: Codes) -> Machines:
        """Train the binary machines on an (n, n) Gram matrix, and centre them if need be."""
        return self.centred(self.trained(gram, codes), gram, codes)

    def trained(self, gram: Matrix, codes: Codes) -> Machines:
        """Train the binary machines alone."""
        train = one_against_one if self.name == "oao" else one_against_all
        return train(gram, codes, self.C, self.weights)

    def at_costs(self, gram: Matrix, codes: Codes, costs: Sequence[float]) -> list[Machines]:
        """Train the binary machines alone, with each of some C in place of this one."""
        if self.name == "oao":
            return one_against_one_at(gram, codes, costs, self.weights)
        return [replace(self, C=C).trained(gram, codes) for C in costs]

    def centred(self, machines: Machines, gram: Matrix, codes: Codes) -> Machines:
        """Return modified one-against-all machines with D_j - mean_j in place of D_j, else as is.

        The mean of D_j is over the very samples of class j that the machine was trained on.
        """
        if self.name != "modified_oaa":
            return machines
        outputs = machines.decide(gram)
        means = [outputs[codes == code, code].mean() for code in range(len(self.classes))]
        return Machines(machines.coefficients, machines.intercepts - np.array(means))

    def held_out(
        self, gram: Matrix, codes: Codes, training: NDArray[np.int64], held_out: NDArray[np.int64]
    ) -> Matrix:
        """Return the outputs for held-out rows of an (n, n) Gram matrix by machines of the rest."""
        machines = self.machines(gram[np.ix_(training, training)], codes[training])
        return machines.decide(gram[np.ix_(held_out, training)])
