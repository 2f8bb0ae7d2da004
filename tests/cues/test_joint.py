"""A cue made of cues: what it asks for, what it makes, and when it is missing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import numpy as np
import pytest
from scipy import sparse

from placecue import (
    Cue,
    Extraction,
    FamilyScaling,
    FeatureParts,
    Observation,
    Pipeline,
    UnusableObservation,
    UsageError,
    contracts,
)
from placecue.errors import ComponentError, ContractError
from placecue.features import stack
from placecue.learning.families import families_of
from placecue_classifiers.svm import SVM
from placecue_cues.joint import Joint
from placecue_cues.laser import LaserGeometry
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import Beams, Brightness, Walk

WALK = list(Walk(rounds=1, stay=3))


class Histogram(Cue):
    """The image's grey levels, of which it wants at least two."""

    requires = ("image",)

    def extract(self, observation: Observation) -> sparse.csr_array:
        assert observation.image is not None
        counts = np.bincount(observation.image.ravel(), minlength=256)[None]
        if np.count_nonzero(counts) < 2:
            raise UnusableObservation("one grey level only")
        return sparse.csr_array(counts / counts.sum())


class Together(Beams):
    """Is asked for batches, and says of how many."""

    def __init__(self, count: int = 4) -> None:
        super().__init__(count)
        self._asked: list[int] = []

    def transform(self, observations: Iterable[Observation]) -> np.ndarray:
        seen = list(observations)
        self._asked.append(len(seen))
        return np.asarray(super().transform(seen))


def test_it_makes_what_its_parts_make() -> None:
    cue = Joint({"beams": Beams(3), "greys": Histogram()})
    assert (cue.requires, cue.learns) == (("image", "scan"), False)
    batch = cue.transform(WALK)
    assert batch.parts["beams"].tolist() == Beams(3).transform(WALK).tolist()
    greys = batch.parts["greys"]
    assert sparse.issparse(greys)
    assert (greys != stack([Histogram().extract(each) for each in WALK])).nnz == 0
    one = cue.features(WALK[4])
    assert isinstance(one, FeatureParts)
    assert one.parts["beams"].tolist() == [Beams(3).extract(WALK[4]).tolist()]


def test_parts_that_learn_are_fitted() -> None:
    cue = Joint({"beams": Beams(), "bright": Brightness()})
    assert cue.learns
    with pytest.raises(UsageError, match="part 'bright' learns: fit it on training observations"):
        cue.transform(WALK)
    cue.fit(WALK, ["?"] * len(WALK))
    alone = Brightness().fit(WALK)
    assert cue.transform(WALK).parts["bright"].tolist() == alone.transform(WALK).tolist()
    assert set(cue.parts_) == {"bright"}
    assert cue.parts is not None
    assert not hasattr(cue.parts["bright"], "center_")  # a copy has learned


def test_parts_are_asked_for_batches() -> None:
    part = Together()
    extracted = Extraction().gather(Joint({"beams": part, "greys": Histogram()}), WALK)
    assert part._asked == [len(WALK)]
    assert isinstance(extracted.features, FeatureParts)
    assert extracted.features.shape == (len(WALK), 4 + 256)


def test_what_alters_observations_for_one_part_alters_them_for_all() -> None:
    cue = Joint({"laser": LaserGeometry(scales=[0.5, 1]), "beams": Beams()})
    [halve] = cue.augmentations()
    halved = cue.features(halve(WALK[0]))
    assert isinstance(halved, FeatureParts)
    assert halved.parts["beams"][0] == pytest.approx(Beams().extract(WALK[0]) / 2)


def test_where_a_part_is_missing_the_cue_is() -> None:
    plain = WALK[0].altered("plain", image=np.full((4, 5, 3), 9, np.uint8))
    dark = Observation(7, scan=WALK[0].scan, label="lab")
    seen = [WALK[1], plain, dark, WALK[2]]
    extracted = Extraction().extract(Joint({"beams": Beams(), "greys": Histogram()}), seen)
    assert extracted.rows.tolist() == [0, 3]
    assert extracted.features is not None
    assert extracted.features.shape[0] == 2
    assert str(extracted.failed[1]) == "one grey level only"
    assert "image" in str(extracted.failed[2])


class Nested(Cue):
    """Makes parts of its own."""

    requires = ("scan",)

    def extract(self, observation: Observation) -> FeatureParts:
        return FeatureParts({"beams": Beams().transform([observation])})


class Short(Beams):
    """Forgets an observation of a batch."""

    def transform(self, observations: Iterable[Observation]) -> np.ndarray:
        return np.asarray(super().transform(observations))[1:]


class Broken(Beams):
    """Fails."""

    def extract(self, observation: Observation) -> np.ndarray:
        raise ZeroDivisionError("by nought")


@pytest.mark.parametrize(
    ("part", "error", "said"),
    [
        (Nested(), ContractError, r"cue '?[Jj]oint'? .*returned parts of its own, in part 'odd'"),
        (Short(), ContractError, r"cue Short .*returned 11 rows for 12 samples"),
        (Broken(), ComponentError, r"cue Broken .*extract failed at stamp 0: .*by nought"),
    ],
)
def test_a_part_that_does_not_do_as_promised_is_named(
    part: Cue, error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        Extraction().extract(Joint({"beams": Beams(), "odd": part}), WALK)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        (None, "joint needs parts, cues by their names, such as parts={crfh: .*, got None"),
        ({}, "joint needs parts"),
        ([Beams()], "joint needs parts"),
        ({"a": Joint({"b": Beams()})}, "takes cues in one piece as parts, got a Joint as 'a'"),
        ({"a": "beams"}, "takes cues in one piece as parts, got .* as 'a'"),
        ({"a__b": Beams()}, "give part 'a__b' a name without '__'"),
    ],
)
def test_wrong_parts(parts: object, said: str) -> None:
    for asked in ("check_parameters", "transform", "fit"):
        with pytest.raises(UsageError, match=said):
            getattr(Joint(parts), asked)(*([WALK] if asked != "check_parameters" else []))  # type: ignore[arg-type]


def test_families_of_parts() -> None:
    laser = LaserGeometry()
    cue = Joint({"laser": laser, "beams": Beams()})
    assert cue.families == {"laser": laser.families}
    batch = cue.transform(WALK)
    assert families_of(cue, batch) == {"laser": tuple(laser.families)}
    for families, said in (
        ({"laser": ["a"] * 3}, "names 3 columns of 182"),
        ({"lazer": ["a"]}, "names the parts lazer of laser, beams"),
    ):
        assert contracts.families(families, batch) == said


def test_each_part_is_scaled_with_its_families() -> None:
    seen = list(Walk(rounds=2, stay=8))
    cue = Joint({"laser": LaserGeometry(), "beams": Beams()})
    pipeline = Pipeline({"joint": (cue, SVM(RBF(0.1), scaling=FamilyScaling()))}).fit(seen)
    scaling = pipeline.cues["joint"].classifier.scaling_  # type: ignore[attr-defined]
    sizes = Counter(LaserGeometry().families)
    expected = [1 / np.sqrt(sizes[name]) for name in LaserGeometry().families]
    assert scaling["laser"].weights_.tolist() == pytest.approx(expected)
    assert scaling["beams"].weights_.tolist() == [1, 1, 1, 1]


def test_a_pipeline_goes_on_without_a_joint_cue() -> None:
    walk = list(Walk(rounds=2, stay=8))
    for dark in range(0, len(walk), 3):
        full = walk[dark]
        walk[dark] = Observation(full.stamp, scan=full.scan, label=full.label)
    joint = Joint({"beams": Beams(), "bright": Brightness()})
    models = {"beams": (Beams(), SVM(RBF(0.1))), "joint": (joint, SVM(RBF(0.01)))}
    beliefs = list(Pipeline(models, SVMDAS(SVM(RBF(0.3)))).fit(walk).beliefs(walk))
    both, one = ("beams", "joint"), ("beams",)
    assert [each.cues_used for each in beliefs] == [both if n % 3 else one for n in range(64)]
