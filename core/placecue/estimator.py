"""What components are made of: a scikit-learn estimator, with types."""

from __future__ import annotations

from typing import Any, Self, TypeVar

from sklearn import base
from sklearn.base import BaseEstimator

from placecue.errors import described
from placecue.guard import step

T = TypeVar("T")


class Estimator(BaseEstimator):  # type: ignore[misc]
    """Keeps its parameters under their own names, so that it can be described, cloned and saved.

    No logic in ``__init__``; parameters are checked by :meth:`check_parameters` when they are
    used, and as soon as a config is built.
    """

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Return the parameters by name, with ``deep`` also those of components inside."""
        parameters: dict[str, Any] = super().get_params(deep)
        return parameters

    def set_params(self, **parameters: Any) -> Self:
        """Set parameters by name; ``inner__name`` is that of a component inside."""
        super().set_params(**parameters)
        return self

    def check_parameters(self) -> None:
        """Raise UsageError if a parameter cannot be what it is; the default accepts all."""


def clone(component: T) -> T:
    """Return an unfitted copy of a component with the same parameters: scikit-learn's, guarded."""

    def wrong(made: object) -> str | None:
        like = type(made) is type(component)
        return None if like else f"returned {described(made)}, not {described(component)}"

    copy: T = step(component, "clone", base.clone, component, check=wrong)
    return copy
