"""Limits: their defaults, what is refused, and that they end where they began."""

from __future__ import annotations

import pytest
from hydra import compose, initialize_config_module

from placecue.components.options import register_with_hydra
from placecue.errors import DataError, UsageError
from placecue.limits import Limits, current_limits, limited
from placecue.nesting import check_depth


def test_a_limit_holds_as_long_as_it_is_set() -> None:
    before = current_limits()
    with limited({"beams": 3}):
        assert current_limits().over("beams", 3) is None
        assert current_limits().over("beams", 4) == "more than limits.beams=3 allows"
        assert current_limits().pixels == before.pixels
    assert current_limits() is before


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"beans": 3}, "there is no limits.beans; did you mean 'beams'"),
        ({"beams": 0}, "limits.beams is 0"),
        ({"beams": True}, "limits.beams is True"),
        ({"beams": "many"}, "limits.beams is 'many'"),
    ],
)
def test_what_is_no_limit_is_refused(given: dict[str, object], said: str) -> None:
    with pytest.raises(UsageError, match=said), limited(given):
        pass


def test_the_config_has_the_defaults_of_the_code() -> None:
    register_with_hydra()
    with initialize_config_module("placecue_conf", version_base="1.3"):
        for command in ("train", "classify", "label", "live", "info", "annotate", "demo"):
            assert dict(compose(command).limits) == {
                name: getattr(Limits(), name) for name in Limits.__slots__
            }


def test_depth_is_that_of_brackets_outside_texts() -> None:
    with limited({"depth": 3}):
        check_depth('{"a": ["[[[[", "\\"[[[[", [1, 2], [3]]}', "it")
        with pytest.raises(DataError, match=r"nested deeper than limits\.depth=3"):
            check_depth('{"a": [[[1]]]}', "it")
