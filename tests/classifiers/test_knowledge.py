"""Places from objects by a table: by hand, without training, and what training adds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import softmax

from placecue import DataError, UsageError
from placecue_classifiers.knowledge import Knowledge, object_names, read_table

OBJECTS = ("bath", "sink", "towel", "stove", "pan", "bed", "lamp")
TABLE = """
bathroom: [bath, sink, towel]
kitchen: [stove, pan, sink]
bedroom: [bed, lamp]
"""
#: Scores of the objects in two images.
SCORES = np.array([[4.0, 2, 3, 0, 1, 0, 2], [0, 1, 0, 5, 3, 2, 1]])


@pytest.fixture
def known(tmp_path: Path) -> dict[str, Any]:
    (tmp_path / "objects.txt").write_text("\n".join(OBJECTS) + "\n")
    (tmp_path / "table.yaml").write_text(TABLE)
    return {"objects": str(tmp_path / "objects.txt"), "table": str(tmp_path / "table.yaml")}


def test_a_place_scores_as_its_largest_objects_do(known: dict[str, Any]) -> None:
    found = Knowledge(top=2, **known).untrained().scores(SCORES)
    assert found.layout.classes == ("bathroom", "bedroom", "kitchen")
    # bathroom: (4 + 3) / 2 and (1 + 0) / 2; bedroom: (0 + 2) / 2, ...; kitchen: (2 + 1) / 2, ...
    wanted = softmax([[3.5, 1, 1.5], [0.5, 1.5, 4]], axis=1)
    np.testing.assert_allclose(found.values, wanted)
    one = Knowledge(top=1, **known).untrained().scores(SCORES)
    np.testing.assert_allclose(one.values, softmax([[4.0, 2, 2], [1, 2, 5]], axis=1))


def test_only_the_places_that_there_are(known: dict[str, Any]) -> None:
    some = Knowledge(places=["Bedroom", "kitchen"], top=1, **known).untrained()
    assert some.scores(SCORES).layout.classes == ("Bedroom", "kitchen")
    np.testing.assert_allclose(some.scores(SCORES).values[1], softmax([2.0, 5]))
    with pytest.raises(UsageError, match="no place 'bathrom'; did you mean 'bathroom'"):
        Knowledge(places=["bathrom", "kitchen"], **known).untrained()
    with pytest.raises(UsageError, match="give a list"):
        Knowledge(places="kitchen", **known).untrained()


def test_a_line_adds_a_place_and_another_changes_one(known: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("sauna: [towel, stove]\nBathroom: [bath]\n")
    mine = Knowledge(more=str(tmp_path / "mine.yaml"), top=1, **known).untrained()
    assert mine.scores(SCORES).layout.classes == ("bathroom", "bedroom", "kitchen", "sauna")
    wanted = softmax([[4.0, 2, 2, 3], [0, 2, 5, 5]], axis=1)
    np.testing.assert_allclose(mine.scores(SCORES).values, wanted)


def test_training_learns_how_sure_to_be_and_how_common_places_look(known: dict[str, Any]) -> None:
    generator = np.random.default_rng(0)
    labels = np.repeat(["bathroom", "bedroom", "kitchen"], 40)
    features = generator.normal(size=(120, 7))
    for row, name in enumerate(labels):
        own = {"bathroom": [0, 2], "bedroom": [5, 6], "kitchen": [3, 4]}[str(name)]
        features[row, own] += 1.5
    features[:, 3] += 4  # there is something like a stove everywhere
    plain, learned = (
        Knowledge(**known).untrained(),
        Knowledge(**known).fit(features, labels),
    )
    assert (plain.predict(features) == labels).mean() < 0.65
    assert (learned.predict(features) == labels).mean() > 0.8
    assert learned.members_.tolist() == plain.members_.tolist()
    offsets = dict(zip(learned.classes_, learned.offsets_, strict=True))
    assert offsets["kitchen"] < min(offsets["bathroom"], offsets["bedroom"])


def test_labels_must_be_places_of_the_table(known: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="the table has no place 'attic'"):
        Knowledge(**known).fit(SCORES, ["attic", "kitchen"])
    with pytest.raises(DataError, match="samples of bathroom, which places= leaves out"):
        Knowledge(places=["bedroom", "kitchen"], **known).fit(SCORES, ["bathroom", "kitchen"])


def test_as_many_names_as_scores(known: dict[str, Any]) -> None:
    for wrong in (SCORES[:, :5], np.ones((2, 1000))):
        with pytest.raises(DataError, match=rf"scores {wrong.shape[1]} objects, and there are 7"):
            Knowledge(**known).untrained().scores(wrong)
        with pytest.raises(DataError, match=r"give classifier\.objects=FILE"):
            Knowledge(**known).fit(wrong, ["bathroom", "kitchen"])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            "sauna: [towle]",
            "sauna has 'towle', which is none of the 7 objects; did you mean 'towel'",
        ),
        ("sauna: towel", "sauna has a str, not a list"),
        ("sauna: []", "sauna has a list, not a list of objects"),
        ("- sauna", "holds a list, not place"),
        ("", "holds None"),
        ("a: [", "is no YAML"),
    ],
)
def test_a_table_that_is_none(
    known: dict[str, Any], tmp_path: Path, text: str, reason: str
) -> None:
    (tmp_path / "mine.yaml").write_text(text)
    with pytest.raises((DataError, UsageError)) as told:
        Knowledge(more=str(tmp_path / "mine.yaml"), **known).untrained()
    assert reason in str(told.value)
    assert "\n" not in str(told.value)


def test_names_of_objects_are_one_a_line(tmp_path: Path) -> None:
    (tmp_path / "twice.txt").write_text("bath\nbath\n")
    with pytest.raises(DataError, match="'bath' stands there twice"):
        object_names(str(tmp_path / "twice.txt"))
    with pytest.raises(DataError, match=r"gone\.txt cannot be read"):
        object_names(str(tmp_path / "gone.txt"))


def test_our_own_table_is_of_imagenet() -> None:
    names, table = object_names(None), read_table(None)
    assert len(names) == 1000
    # Of ImageNet's list, by its numbers.
    known = {435: "bathtub", 526: "desk", 651: "microwave", 664: "monitor", 861: "toilet seat"}
    assert {number: names[number] for number in known} == known
    assert len(table) >= 17
    assert Knowledge().untrained().members_.sum(axis=1).min() >= 1
    assert all(each in names for objects in table.values() for each in objects)
