"""Cues, accumulators and boundaries that misbehave where the pipeline calls them."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from misbehaving import MISDEEDS, interrupt
from placecue import (
    Accumulator,
    AreaUpdate,
    Belief,
    Boundary,
    Cue,
    FoldScheme,
    Observation,
    Pipeline,
    Pose2D,
    SemanticMap,
)
from placecue.errors import ComponentError, ContractError, Interrupted
from placecue_accumulators.spatiotemporal import SpatioTemporal
from placecue_classifiers.svm import SVM
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.rbf import RBF
from toys import Beams, Brightness, Walk, pipeline

#: The fourth observation of every log.
STAMP = 600_000_000
AT = f"at stamp {STAMP} of walk 0"


class FaultyCue(Beams):
    """Does something else at one observation."""

    def __init__(self, deed: Any = None) -> None:
        super().__init__()
        self.deed = deed

    def extract(self, observation: Observation) -> Any:
        sound = super().extract(observation)
        return self.deed() if observation.stamp == STAMP else sound


class FaultyBoundary(Boundary):
    """Does something else at one observation."""

    def __init__(self, deed: Any = None) -> None:
        self.deed = deed

    def update(self, observation: Observation) -> Any:
        return self.deed() if observation.stamp == STAMP else None

    def reset(self) -> None:
        pass


class FaultyAccumulator(Accumulator):
    """Does something else at one observation."""

    def __init__(self, deed: Any = None) -> None:
        self.deed = deed

    def update(self, observation: Observation, belief: Belief | None) -> AreaUpdate | None:
        return self.deed() if observation.stamp == STAMP else None

    def semantic_map(self) -> SemanticMap:
        return SemanticMap((), (), (), ())

    def reset(self) -> None:
        pass


@pytest.fixture(scope="module")
def fitted() -> Pipeline:
    return pipeline().fit(Walk())


def label(fitted: Pipeline, kind: str, deed: Any) -> None:
    """Run a component that does the deed where it is called for one observation."""
    accumulator: Accumulator = FaultyAccumulator(deed)
    if kind == "boundary":
        accumulator = SpatioTemporal(boundary=FaultyBoundary(deed))
    if kind == "cue":
        cue = FaultyCue(deed)
        fitted = Pipeline({"beams": (cue, SVM(kernel=RBF(gamma=0.1)))})
        fitted.fit(Walk())
    list(fitted.label(Walk(rounds=1), accumulator))


METHODS = {"cue": "extract", "boundary": "update", "accumulator": "update"}


@pytest.mark.parametrize("misdeed", MISDEEDS)
@pytest.mark.parametrize("kind", METHODS)
def test_what_it_does_wrong_is_one_line(fitted: Pipeline, kind: str, misdeed: str) -> None:
    deed, told = MISDEEDS[misdeed]
    with pytest.raises(ComponentError) as caught:
        label(fitted, kind, deed)
    who = f"{kind} Faulty{kind.title()} ({__name__})"
    assert str(caught.value).startswith(f"{who}: {METHODS[kind]} failed {AT}: {told}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", METHODS)
def test_an_interrupt_names_it(fitted: Pipeline, kind: str) -> None:
    with pytest.raises(Interrupted) as caught:
        label(fitted, kind, interrupt)
    who = f"{kind} Faulty{kind.title()} ({__name__})"
    assert str(caught.value) == f"interrupted in {METHODS[kind]} of {who} {AT}"


@pytest.mark.parametrize(
    ("kind", "made", "said"),
    [
        ("cue", None, "returned None, not a vector"),
        ("cue", [1.0, 2.0], "returned a list, not a vector"),
        ("cue", np.array(["a"], object), "returned an array of object"),
        ("cue", np.zeros((2, 2, 2)), r"returned an array of shape \(2, 2, 2\)"),
        ("boundary", True, "returned a bool, not a Pose2D or None"),
        ("boundary", (1.0, 2.0), "returned a tuple, not a Pose2D or None"),
        ("boundary", Pose2D(np.nan, 0, 0), "returned a Pose2D whose x is nan"),
        ("accumulator", "lab", "returned a str, not an AreaUpdate or None"),
        ("accumulator", AreaUpdate(1, None, 0.5), "returned an AreaUpdate whose label is None"),
    ],
)
def test_what_it_returns_wrongly_is_one_line(
    fitted: Pipeline, kind: str, made: Any, said: str
) -> None:
    who = rf"{kind} Faulty{kind.title()} \({__name__}\)"
    with pytest.raises(ContractError, match=f"^{who}: {METHODS[kind]} {said}.*, {AT}$"):
        label(fitted, kind, lambda: made)


# ---------------------------------------------------------------------- writing into observations


class Painter(Cue):
    """Blackens the image it looks at."""

    requires = ("image",)

    def extract(self, observation: Observation) -> np.ndarray:
        observation.image[...] = 0
        return observation.image.mean(axis=(0, 1))


class Shortener(Beams):
    """Shortens the beams."""

    def extract(self, observation: Observation) -> np.ndarray:
        ranges = observation.scan.ranges
        ranges *= 0.5
        return ranges


class Labeller(Beams):
    """Writes a label."""

    def extract(self, observation: Observation) -> np.ndarray:
        observation.label = "office"
        return super().extract(observation)


@pytest.mark.parametrize(
    ("cue", "said"),
    [
        (Painter(), "ValueError: assignment destination is read-only"),
        (Shortener(), "ValueError: output array is read-only"),
        (Labeller(), "AttributeError: observations are read-only, so label cannot be set"),
    ],
)
def test_a_cue_that_writes_changes_nothing_and_is_named(cue: Cue, said: str) -> None:
    cues = {
        "writer": (cue, SVM(kernel=RBF())),
        "beams": (Beams(), SVM(kernel=RBF())),
        "brightness": (Brightness(), SVM(kernel=RBF())),
    }
    log = list(Walk())
    before = [(each.image.copy(), each.scan.ranges.copy(), each.label) for each in log]
    who = rf"cue {type(cue).__name__} \({__name__}\)"
    with pytest.raises(ComponentError, match=f"^{who}: extract failed at stamp 0: {said}"):
        Pipeline(cues, SVMDAS(classifier=SVM(kernel=RBF()))).fit(log)
    for each, (image, ranges, label) in zip(log, before, strict=True):
        assert (each.image == image).all()
        assert (each.scan.ranges == ranges).all()
        assert each.label == label


# ---------------------------------------------------------------------- folds


class FaultyFolds(FoldScheme):
    """Does something else where samples are dealt to folds."""

    def __init__(self, deed: Any = None) -> None:
        super().__init__()
        self.deed = deed

    def assign(self, labels: ArrayLike, stamps: ArrayLike | None = None, *more: Any) -> Any:
        return self.deed()


@pytest.mark.parametrize(
    ("deed", "said"),
    [
        (MISDEEDS["raises"][0], "failed: ValueError: two lines"),
        (MISDEEDS["leaves"][0], "failed: SystemExit: 3"),
        (lambda: [0, 1], r"returned a list, not whole numbers, shape \(320,\)"),
        (lambda: np.zeros(3, int), r"returned an array of shape \(3,\), not \(320,\)"),
        (lambda: np.full(320, 5), "returned folds 5 to 5, not -1 to 4"),
    ],
)
def test_folds_that_misbehave_are_one_line(deed: Any, said: str) -> None:
    made = pipeline()
    made.folds = FaultyFolds(deed=deed)
    who = rf"folds FaultyFolds \({__name__}\)"
    with pytest.raises(ComponentError, match=f"^{who}: assign {said}$"):
        made.fit(Walk())
