"""The starter: its places, the rule by which laser and objects are joined, and the model."""

from __future__ import annotations

import numpy as np
import pytest

from placecue import Classifier, Probabilities, Scores, UsageError
from placecue.components.manager import load_plugins
from placecue.evidence import StoredEvidence
from placecue.starter.in_places import InPlaces
from placecue.starter.pipeline import MODEL, InTerms, Starter
from placecue.starter.places import Places, chosen
from placecue.starter.rule import LaserThenObjects
from rooms import Rooms

REGISTRY = load_plugins(built_ins_only=True).registry


class Fixed(Classifier):
    """Says the same of every sample."""

    def __init__(self, values: list[list[float]], classes: tuple[str, ...]) -> None:
        self.values = values
        self.layout_ = Probabilities(classes)

    def fit(self, features: object, labels: object, stamps: object = None) -> Fixed:
        return self

    def scores(self, features: object) -> Scores:
        return Scores(np.array(self.values), self.layout_)


KINDS = ("corridor", "kitchen", "office")
LASER = ("corridor", "doorway", "room")


def test_all_that_is_known() -> None:
    assert chosen(None, (), False).classes == ("corridor", "doorway", "room")
    assert chosen(None, KINDS, False).classes == ("corridor", "doorway", "room")
    every = ("corridor", "doorway", "kitchen", "office", "room")
    assert chosen(None, KINDS, True).classes == every


@pytest.mark.parametrize(
    ("wanted", "sees_objects", "classes"),
    [
        (["office", "kitchen", "corridor"], True, ("corridor", "kitchen", "office", "room")),
        (["office", "kitchen", "corridor"], False, ("corridor", "room")),
        (["office", "corridor"], True, ("corridor", "office")),
        (["office", "corridor"], False, ("corridor", "office")),
        (["corridor", "doorway"], False, ("corridor", "doorway")),
        (["room", "corridor"], False, ("corridor", "room")),
    ],
)
def test_what_a_building_has(wanted: list[str], sees_objects: bool, classes: list[str]) -> None:
    assert chosen(wanted, KINDS, sees_objects).classes == classes


@pytest.mark.parametrize(
    ("wanted", "kinds", "said"),
    [
        (["offise", "corridor"], KINDS, "nobody knows 'offise'.*: corridor, doorway, kitchen, off"),
        (["office", "corridor"], (), r"nobody knows 'office'.*pip install 'placecue\[deep\]'"),
        (["office", "kitchen"], KINDS, "laser alone tells"),
        (["corridor"], KINDS, "two or more"),
        ("office", KINDS, "no list"),
    ],
)
def test_places_that_cannot_be(wanted: object, kinds: tuple[str, ...], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        chosen(wanted, kinds, False)


@pytest.mark.parametrize(
    ("classes", "told"),
    [
        # corridor, doorway, room of the laser: 0.3, 0.2, 0.5.
        (("corridor", "doorway", "room"), [0.3, 0.2, 0.5]),
        (("corridor", "room"), [0.375, 0.625]),
        (("corridor", "office"), [0.375, 0.625]),
        (("corridor", "kitchen", "office", "room"), [0.375, 0, 0, 0.625]),
        (("doorway", "kitchen"), [2 / 7, 5 / 7]),
    ],
)
def test_laser_in_places(classes: tuple[str, ...], told: list[float]) -> None:
    laser = Fixed([[0.3, 0.2, 0.5]], LASER)
    scores = InPlaces(laser, Places(classes)).scores(np.zeros((1, 1)))
    assert scores.layout == Probabilities(classes)
    np.testing.assert_allclose(scores.values, [told])


def test_nothing_left_says_nothing() -> None:
    laser = Fixed([[0.0, 1.0, 0.0]], LASER)
    scores = InPlaces(laser, Places(("corridor", "room"))).scores(np.zeros((1, 1)))
    np.testing.assert_allclose(scores.values, [[0.5, 0.5]])


PLACES = Places(("corridor", "doorway", "kitchen", "office", "room"))
NONE = [np.nan] * 5


def joined(laser: list[float], objects: list[float]) -> Scores:
    layout = Probabilities(PLACES.classes)
    both = {
        "laser": Scores(np.array([laser]), layout),
        "objects": Scores(np.array([objects]), layout),
    }
    return LaserThenObjects(PLACES).integrate(StoredEvidence(both))


def test_laser_says_room_and_objects_which() -> None:
    told = joined([0.2, 0.2, 0, 0, 0.6], [0, 0, 0.25, 0.75, 0])
    # office 0.6, kitchen 0.6 / 3 = 0.2, corridor and doorway 0.2 each: in all 1.2. They agree.
    np.testing.assert_allclose(told.values, [[1 / 6, 1 / 6, 1 / 6, 0.5, 0]])
    assert told.decide().labels.tolist() == ["office"]


def test_laser_decides_corridor_and_doubt_halves_the_lead() -> None:
    agreed = joined([0.8, 0, 0, 0, 0.2], [1, 0, 0, 0, 0])
    doubted = joined([0.8, 0, 0, 0, 0.2], [1e-12, 0, 0.5, 0.5, 0])
    assert agreed.decide().labels.tolist() == doubted.decide().labels.tolist() == ["corridor"]
    # 0.8 against two kinds of 0.2: in all 1.2, a lead of 0.5; half of it where objects see rooms.
    assert agreed.decide().confidence[0] == pytest.approx(0.5)
    assert doubted.decide().confidence[0] == pytest.approx(0.25)
    assert doubted.values.sum() == pytest.approx(1)


def test_a_room_in_which_objects_see_a_corridor() -> None:
    told = joined([0.4, 0, 0, 0, 0.6], [0.5, 0, 0.5, 0, 0])
    # kitchen 0.6, corridor 0.4, the lead 0.2 times (1 + 0.5) / 2.
    assert told.decide().labels.tolist() == ["kitchen"]
    assert told.decide().confidence[0] == pytest.approx(0.15)


def test_either_alone() -> None:
    laser, objects = [0.2, 0.2, 0, 0, 0.6], [0.1, 0, 0.3, 0.6, 0]
    np.testing.assert_allclose(joined(laser, NONE).values, [laser])
    np.testing.assert_allclose(joined(NONE, objects).values, [objects])
    assert np.isnan(joined(NONE, NONE).values).all()


def test_a_label_that_is_no_place_is_told_once(caplog: pytest.LogCaptureFixture) -> None:
    labels = {each.label for each in InTerms(Rooms(2, 1), PLACES)}
    assert labels == {"corridor", "kitchen", "lab", "office"}
    [told] = caplog.messages
    assert told.startswith("'lab' in rooms 0 is none of the starter's places")
    assert "label_map={lab: PLACE}" in told


def test_labels_of_a_log_in_terms_of_the_starter() -> None:
    laser = Places(("corridor", "doorway", "room"))
    assert [laser.truth(name) for name in ("kitchen", "hallway", "door", "room", None)] == [
        *("room", "corridor", "doorway", "room", None)
    ]
    assert PLACES.truth("kitchen") == "kitchen"
    assert PLACES.truth("bathroom") == "bathroom"


def test_the_model_is_small_and_of_the_versions_installed() -> None:
    """It loads without a warning, or ``placecue train +recipe=starter`` has to be run again."""
    assert sum(path.stat().st_size for path in MODEL.iterdir()) < 2_000_000
    pipeline = Starter(REGISTRY).pipeline(None, laser=True, image=False)
    assert pipeline.classes == ("corridor", "doorway", "room")


def test_the_model_on_plans_of_another_seed() -> None:
    """Chance is a third; what it comes to at full length stands in docs/starter.md."""
    from placecue_sources.plans.source import Plans

    pipeline = Starter(REGISTRY).pipeline(None, laser=True, image=False)
    source = Plans(plans=8, samples=24, seed=77, field_of_view=[180.0, 360.0])
    log = list(InTerms(source, Places(pipeline.classes)))
    right = [belief.label == each.label for each, belief in pipeline.follow(log, 16) if belief]
    assert np.mean(right) > 0.6


def test_mixed_fields_of_view() -> None:
    """One model for all: scans of a full turn among those of half a turn need nothing else."""
    from placecue_sources.plans.source import Plans

    pipeline = Starter(REGISTRY).pipeline(None, laser=True, image=False)
    half, full = (
        list(Plans(plans=1, samples=3, seed=1, field_of_view=[degrees]))
        for degrees in (180.0, 360.0)
    )
    mixed = [each for pair in zip(half, full, strict=True) for each in pair]
    alone = [belief.label for each in mixed for belief in pipeline.believe([each])]
    assert [belief.label for belief in pipeline.believe(mixed)] == alone
