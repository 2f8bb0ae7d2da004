"""Methods by words: names that are met twice, words that make no sense."""

import pytest

from placecue.errors import UsageError
from placecue.evaluation.protocol.methods import methods_of


def composed(words):
    """A config with as many words as it was given, in place of Hydra's."""
    return {"cues": {"laser": {"plugin": "laser", "words": words, "classifier": {}}}}


def test_what_for_lists_is_filled_in():
    spec = {"words": "cue=laser cues.laser.preset={p}", "for": {"p": ["full", "group"]}}
    found = methods_of({"laser {p}": spec}, None, composed)
    assert {name: each.cue["words"][1] for name, each in found.models.items()} == {
        "laser full": "cues.laser.preset=full",
        "laser group": "cues.laser.preset=group",
    }


@pytest.mark.parametrize(
    ("models", "said"),
    [
        ({"laser": {"words": "cue=laser x={p}", "for": {"p": [1, 2]}}},
         "two methods are called 'laser': give each a name of its own, with what 'for' lists"),
        ({"laser": "cue='laser"}, "the words of 'laser' (cue='laser) make no sense: No closing"),
        ({"laser {p.x}": {"words": "cue=laser", "for": {"p": [1]}}}, "cannot be filled in"),
        ({"laser {q}": {"words": "cue=laser", "for": {"p": [1]}}}, "cannot be filled in ('q')"),
        ([], "no method to evaluate"),
    ],
)  # fmt: skip
def test_what_makes_no_sense(models, said):
    with pytest.raises(UsageError) as error:
        methods_of(models, None, composed)
    assert said in str(error.value)
