"""What a parameter search tries: every combination of the listed values."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from placecue.errors import UsageError, choices

Setting = dict[str, Any]

#: Parameters that a Gram matrix does not depend on.
OF_MACHINES = ("class_weight", "multiclass", "C")


@dataclass(frozen=True, slots=True)
class Grid:
    """Values to try, by the name of the parameter.

    Parameters
    ----------
    values : dict of str to list
        ``C``, ``gamma`` (of the kernel), ``multiclass``, ``class_weight``, ``scaling``, and any
        parameter of the kernel as ``kernel__NAME``.
    light : collection of str
        Those of the kernel's parameters for which features and distances stay as they are.
    """

    values: dict[str, list[Any]]
    light: Collection[str] = ()

    @classmethod
    def of(
        cls,
        values: Mapping[str, Sequence[Any]],
        known: Sequence[str],
        light: Collection[str] = (),
    ) -> Grid:
        """Read a config.

        Parameters
        ----------
        values : mapping of str to sequence
            Values to try.
        known : sequence of str
            The parameters that can be searched.
        light : collection of str
            The kernel's light parameters, by the kernel's own names.

        Raises
        ------
        UsageError
            If a parameter cannot be searched, a list is empty, or C or gamma is not above 0.
        """
        for name, tried in values.items():
            if name not in known:
                raise UsageError(
                    f"search cannot vary '{name}' of this SVM and kernel; {choices(name, known)}; "
                    f"take it out with ...search.{name}=null"
                )
            check_listed(name, tried)
            positive = name == "C" or name.rsplit("__", 1)[-1] == "gamma"
            if positive and not all(map(_positive, tried)):
                raise UsageError(f"search.{name} must list values above 0, got {list(tried)}")
        named = {"gamma" if n == "kernel__gamma" else n: list(v) for n, v in values.items()}
        if len(named) < len(values):
            raise UsageError("search lists gamma and kernel__gamma, which are the same: keep one")
        return cls(named, {_of_svm(name) for name in light})

    def preparations(self) -> Iterator[Setting]:
        """Yield the settings for which features or distances have to be computed anew."""
        return self._product(n for n in self.values if n not in (*OF_MACHINES, *self.light))

    def lights(self) -> list[Setting]:
        """Return the settings that share features and distances."""
        return list(self._product(n for n in self.values if n in self.light))

    def parted(self, setting: Setting) -> tuple[Setting, Setting]:
        """Return what :meth:`preparations` and :meth:`lights` yield for a setting of everything."""
        kept = {n: v for n, v in setting.items() if n not in OF_MACHINES}
        light = {n: kept.pop(n) for n in setting if n in self.light}
        return kept, light

    def machines(self) -> list[Setting]:
        """Return the settings that share a Gram matrix, C varying fastest."""
        return list(self._product(n for n in OF_MACHINES if n in self.values))

    def _product(self, names: Iterator[str]) -> Iterator[Setting]:
        return settings({name: self.values[name] for name in names})


def _of_svm(name: str) -> str:
    return name if name == "gamma" else f"kernel__{name}"


def settings(values: Mapping[str, Sequence[Any]]) -> Iterator[Setting]:
    """Yield every combination of values, the last parameter varying fastest."""
    for each in product(*values.values()):
        yield dict(zip(values, each, strict=True))


def check_listed(name: str, tried: Any) -> None:
    """Raise UsageError unless the values to try are a list of some."""
    if isinstance(tried, str) or not isinstance(tried, Sequence) or not tried:
        raise UsageError(f"search.{name} must be a list of values to try, got {tried!r}")


def _positive(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value > 0
