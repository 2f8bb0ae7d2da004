"""One door around every call of a component: what comes out is right, or one line."""

import importlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sklearn
from sklearn.preprocessing import StandardScaler

import placecue
from misbehaving import MISDEEDS, interrupt
from placecue import Cue, DataError, Observation, UnusableObservation, UsageError
from placecue.classifier import UnfitSamples
from placecue.components.hooks import KINDS
from placecue.components.manager import load_plugins
from placecue.components.registry import Registry
from placecue.errors import ComponentError, ContractError, Interrupted, PlacecueError
from placecue.guard import call, step
from placecue.ownership import INTERFACES, provenance
from placecue_classifiers.svm import SVM
from toys import Beams, Walk

#: What is told of a cue of this file, which is of no distribution.
WHO = f"cue Doing ({__name__})"


class Doing(Cue):
    """Does what it was given to do."""

    def __init__(self, deed: Callable[[], Any]) -> None:
        self.deed = deed

    def extract(self, observation: Observation) -> Any:
        return self.deed()


@pytest.fixture
def observation() -> Observation:
    return Walk().at(3).of_log("run1.mcap")


def test_what_is_returned_comes_through() -> None:
    made = np.arange(3)
    assert call(Doing(lambda: made), "extract", None) is made
    assert call("a-b", "split", "-", maxsplit=1, check=lambda made: None) == ["a", "b"]


@pytest.mark.parametrize("misdeed", MISDEEDS)
def test_what_a_component_does_wrong_is_one_line(misdeed: str, observation: Observation) -> None:
    deed, told = MISDEEDS[misdeed]
    with pytest.raises(ComponentError) as caught:
        call(Doing(deed), "extract", observation, at=observation)
    start = f"{WHO}: extract failed at stamp 600000000 of run1.mcap: "
    assert str(caught.value).startswith(start + told)
    assert "\n" not in str(caught.value)
    cause = caught.value.__cause__
    assert cause is not None
    assert type(cause).__name__ == told.partition(":")[0]


def test_without_an_observation_no_stamp_is_told() -> None:
    with pytest.raises(ComponentError, match=r"^cue Doing \([\w.]+\): extract failed: Sys"):
        call(Doing(MISDEEDS["leaves"][0]), "extract", None)


def test_a_method_that_is_not_there_is_the_component_s_fault() -> None:
    with pytest.raises(ComponentError, match="no attribute 'extractt'"):
        call(Beams(), "extractt")


def test_a_long_text_is_cut() -> None:
    def wordy() -> None:
        raise ValueError("x" * 100_000)

    with pytest.raises(ComponentError) as caught:
        call(Doing(wordy), "extract", None)
    assert len(str(caught.value)) < 600


@pytest.mark.parametrize("kind", [UnusableObservation, DataError, UsageError, UnfitSamples])
def test_our_own_errors_pass_as_they_are(kind: type[PlacecueError]) -> None:
    error = kind("nothing to see")

    def refuse() -> None:
        raise error

    with pytest.raises(kind) as caught:
        call(Doing(refuse), "extract", None)
    assert caught.value is error


def test_the_innermost_component_is_blamed() -> None:
    inner = Doing(MISDEEDS["raises"][0])
    with pytest.raises(ComponentError, match=r"^cue Doing"):
        step(Walk(), "iteration", lambda: call(inner, "extract", None))


def test_an_interrupt_names_whom_it_stopped(observation: Observation) -> None:
    inner = Doing(interrupt)
    with pytest.raises(KeyboardInterrupt) as caught:
        step(Walk(), "iteration", lambda: call(inner, "extract", observation, at=observation))
    assert type(caught.value) is Interrupted
    assert str(caught.value) == (f"interrupted in extract of {WHO} at stamp 600000000 of run1.mcap")
    assert type(caught.value.__cause__) is KeyboardInterrupt


def test_a_broken_promise_is_an_error_of_its_own(observation: Observation) -> None:
    asked = []

    def check(made: Any) -> str:
        asked.append(made)
        return "returned 1 row for 3 samples"

    with pytest.raises(ContractError) as caught:
        call(Doing(lambda: 7), "extract", None, check=check, at=observation)
    assert asked == [7]
    assert str(caught.value) == (
        f"{WHO}: extract returned 1 row for 3 samples, at stamp 600000000 of run1.mcap"
    )


def test_where_a_check_itself_trips_over_the_result_the_component_is_blamed() -> None:
    with pytest.raises(ComponentError, match="extract failed: TypeError"):
        call(Doing(lambda: object()), "extract", None, check=len)


# ---------------------------------------------------------------------- who it was


def test_a_component_loaded_by_name_has_its_name_and_distribution() -> None:
    registry = Registry()
    registry.add([placecue.Component("cue", "doing", f"{__name__}:Doing")], "depth-cues", "1.2")
    loaded = registry.load("cue", "doing")
    try:
        with pytest.raises(ComponentError, match=r"^cue 'doing' \(depth-cues 1\.2\): extract"):
            call(loaded(MISDEEDS["leaves"][0]), "extract", None)
    finally:
        from placecue import ownership as module

        del module._REMEMBERED[loaded]


def test_built_ins_have_theirs_too() -> None:
    crfh = load_plugins(built_ins_only=True).registry.load("cue", "crfh")
    assert str(provenance(crfh())) == f"cue 'crfh' (placecue {placecue.__version__})"


def test_a_component_made_without_its_name_has_its_class() -> None:
    class Stubborn(SVM):
        pass

    Stubborn.__module__ = SVM.__module__
    name = f"{test_a_component_made_without_its_name_has_its_class.__name__}.<locals>.Stubborn"
    expected = f"classifier {name} (placecue {placecue.__version__})"
    assert str(provenance(Stubborn())) == expected


def test_what_is_of_no_kind_still_has_a_distribution() -> None:
    expected = f"component StandardScaler (scikit-learn {sklearn.__version__})"
    assert str(provenance(StandardScaler())) == expected


def test_what_is_of_no_distribution_has_its_module() -> None:
    assert str(provenance(Doing(dict))) == WHO


def test_every_kind_has_an_interface() -> None:
    assert set(KINDS) <= set(INTERFACES.values())
    for path in INTERFACES:
        module, _, name = path.rpartition(".")
        assert isinstance(getattr(importlib.import_module(module), name), type)
