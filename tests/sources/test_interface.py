"""Every registered source is what the interface says, whatever its parameters are called."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from functools import cached_property

import pytest

from placecue.camera import PinholeCamera
from placecue.components.manager import load_plugins
from placecue.source import Source

REGISTRY = load_plugins(built_ins_only=True).registry
KINDS = {
    "name": str,
    "camera": (PinholeCamera, type(None)),
    "metadata": Mapping,
    "reads_many": bool,
}


def made(name: str) -> Source:
    """Return a source with nothing given but what it must be given."""
    kind = REGISTRY.load("source", name)
    needed = [
        parameter
        for parameter, each in inspect.signature(kind).parameters.items()
        if each.default is inspect.Parameter.empty
    ]
    where = "ws://nowhere" if name == "foxglove" else "nowhere"
    source = kind(**dict.fromkeys(needed, where))
    assert isinstance(source, Source)
    return source


@pytest.mark.parametrize("name", REGISTRY.names("source"))
def test_no_parameter_shadows_what_a_source_says_of_itself(name: str) -> None:
    source = made(name)
    own = vars(source)
    for attribute, kind in KINDS.items():
        # What is looked up in the log cannot be, which is nowhere; parameters are stored.
        looked_up = isinstance(getattr(type(source), attribute), (property, cached_property))
        if attribute in own or not looked_up:
            assert isinstance(getattr(source, attribute), kind), attribute
    methods = (each for each in dir(Source) if callable(getattr(Source, each)))
    assert not [method for method in methods if method in own]


def test_the_kinds_are_those_of_the_interface() -> None:
    assert KINDS.keys() == Source.__annotations__.keys()
