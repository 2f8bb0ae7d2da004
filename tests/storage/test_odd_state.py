"""Components that cannot be described, saved or restored: an error names them."""

from __future__ import annotations

from typing import Any

import pytest

from misbehaving import MISDEEDS
from placecue.components.build import describe
from placecue.errors import ComponentError, DataError, UsageError
from placecue.storage.state import Decoder, Encoder
from toys import Beams, registry


def test_what_holds_itself_cannot_be_saved() -> None:
    cue = Beams()
    cue.seen_ = []
    cue.seen_.append(cue.seen_)
    with pytest.raises(UsageError, match=r"^cues\.beams has learned what holds itself"):
        Encoder(registry()).state(cue, "cues.beams")


@pytest.mark.parametrize("misdeed", ["raises", "leaves"])
def test_a_component_that_fails_on_what_it_has_learned(misdeed: str) -> None:
    deed, told = MISDEEDS[misdeed]
    cue: Any = Beams()
    cue.check_learned = deed
    who = r"cue ('beams' \(toys 1\.0\)|Beams \(toys\))"
    with pytest.raises(DataError, match=f"^what {who} has learned does not fit together: {told}$"):
        Decoder(registry(), {}, None).restore(cue, {})


def test_a_component_that_cannot_tell_its_parameters() -> None:
    cue: Any = Beams()
    cue.get_params = lambda deep: MISDEEDS["raises"][0]()
    with pytest.raises(
        ComponentError, match=r"^cue .*toys.*: get_params failed: ValueError: two l"
    ):
        describe(cue, registry())
