"""Sources as anybody may have written them: each is one line that names it, and where it was."""

from collections.abc import Iterable, Iterator
from typing import Any

import pytest

from misbehaving import MISDEEDS, interrupt
from placecue import DataError, Observation, Pipeline, Source
from placecue.errors import ComponentError, ContractError, Interrupted
from placecue.labelling import run_log
from placecue.labels.label_map import LabelMap
from placecue.labels.relabelled import Relabelled
from placecue.source import Chain, Guarded, guarded, innermost
from toys import Walk, pipeline

WHO = rf"source Faulty \({__name__}\)"


class Faulty(Walk):
    """Does something else after three observations."""

    def __init__(self, deed: Any = None, **parameters: int) -> None:
        super().__init__(**parameters)
        self.deed = deed

    def __iter__(self) -> Iterator[Any]:
        for number in range(3):
            yield self.at(number)
        yield self.deed()


@pytest.fixture(scope="module")
def fitted() -> Pipeline:
    return pipeline().fit(Walk())


def consumers(fitted: Pipeline) -> dict[str, Any]:
    """Every way into placecue that a source can take as a library."""
    names = LabelMap({"lab": "office"})
    return {
        "guarded": lambda source: list(guarded(source)),
        "beliefs": lambda source: list(fitted.beliefs(source)),
        "follow": lambda source: list(fitted.follow(source, batch=2)),
        "run_log": lambda source: run_log(fitted, source, []),
        "fit": lambda source: pipeline().fit(source),
        "chain": lambda source: list(Chain([Walk(rounds=1), source])),
        "relabelled": lambda source: list(Relabelled(source, label_map=names)),
    }


CONSUMERS = ("guarded", "beliefs", "follow", "run_log", "fit", "chain", "relabelled")


@pytest.mark.parametrize("consumer", CONSUMERS)
def test_a_source_that_fails_is_named_with_the_place(fitted: Pipeline, consumer: str) -> None:
    consume = consumers(fitted)[consumer]
    for misdeed in ("raises", "leaves"):
        deed, told = MISDEEDS[misdeed]
        said = f"^{WHO}: iteration failed at observation 3 of walk 0: {told}$"
        with pytest.raises(ComponentError, match=said):
            consume(Faulty(deed))


@pytest.mark.parametrize("consumer", CONSUMERS)
def test_a_source_that_gives_nonsense_too(fitted: Pipeline, consumer: str) -> None:
    said = f"^{WHO}: iteration returned a dict, not an Observation, at observation 3 of walk 0$"
    with pytest.raises(ContractError, match=said):
        consumers(fitted)[consumer](Faulty(dict))


@pytest.mark.parametrize("consumer", CONSUMERS)
def test_an_interrupted_source_is_named(fitted: Pipeline, consumer: str) -> None:
    said = f"^interrupted in iteration of {WHO} at observation 3 of walk 0$"
    with pytest.raises(Interrupted, match=said):
        consumers(fitted)[consumer](Faulty(interrupt))


@pytest.mark.parametrize("misdeed", MISDEEDS)
def test_every_misdeed_of_a_source(misdeed: str) -> None:
    deed, told = MISDEEDS[misdeed]
    seen = []
    with pytest.raises(ComponentError) as caught:
        seen += iter(guarded(Faulty(deed)))  # what came before is handed out
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


class Iterating(Walk):
    """Is iterated by what it was given."""

    def __init__(self, iterator: Any) -> None:
        super().__init__()
        self.iterator = iterator

    def __iter__(self) -> Any:
        return self.iterator()


@pytest.mark.parametrize(
    ("iterator", "said"),
    [
        (lambda: [Walk().at(0)], "iteration failed: TypeError: iter.. returned non-iterator"),
        (lambda: None, "iteration failed: TypeError: iter.. returned non-iterator"),
        (MISDEEDS["leaves"][0], "iteration failed: SystemExit: 3"),
        (lambda: iter([None]), "iteration returned None, not an Observation, at observation 0"),
        (lambda: iter([Observation(1.5)]), "whose stamp is 1.5, not a whole number of ns"),
        (lambda: iter([Observation(1, label=2)]), "whose label is 2, not a text or None"),
    ],
)
def test_an_iterator_that_is_none(iterator: Any, said: str) -> None:
    with pytest.raises(ComponentError, match=said):
        list(guarded(Iterating(iterator)))


class Describing(Walk):
    """Says of itself what it was given to say."""

    def __init__(self, **said: Any) -> None:
        super().__init__()
        self.said = said

    def __getattribute__(self, name: str) -> Any:
        said = super().__getattribute__("__dict__").get("said", {})
        if name in said and name in ("name", "metadata", "camera"):
            return said[name]() if callable(said[name]) else said[name]
        return super().__getattribute__(name)

    def digest(self) -> Any:
        return self._of("digest")

    def count(self) -> Any:
        return self._of("count")

    def _of(self, name: str) -> Any:
        value = self.said[name]
        return value() if callable(value) else value


def said_of(source: Source, name: str) -> Any:
    attribute = getattr(guarded(source), name)
    return attribute() if callable(attribute) else attribute


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("name", 7, "name is 7, not a text"),
        ("name", MISDEEDS["raises"][0], "name failed: ValueError: two lines"),
        ("metadata", ["run"], "metadata is a list, not a mapping of texts"),
        ("metadata", {"run": 1}, "metadata holds an int under 'run', not a text"),
        ("camera", "left", "camera is 'left', not a PinholeCamera or None"),
        ("digest", None, "digest is None, not a text"),
        ("digest", MISDEEDS["leaves"][0], "digest failed: SystemExit: 3"),
        ("count", "many", "count returned 'many', not a number of observations or None"),
        ("count", MISDEEDS["recurses"][0], "count failed: RecursionError"),
    ],
)
def test_what_a_source_says_of_itself_is_checked(name: str, value: Any, said: str) -> None:
    with pytest.raises(ComponentError, match=rf"^source Describing \({__name__}\): {said}"):
        said_of(Describing(**{name: value}), name)


def test_a_sound_source_is_what_it_was() -> None:
    source = Walk(rounds=1)
    source.metadata = {"run": "1"}  # type: ignore[misc]
    behind = guarded(source)
    assert [each.stamp for each in behind] == [each.stamp for each in source]
    assert [each.stamp for each in behind] == [each.stamp for each in source]  # and again
    assert (behind.name, behind.count(), behind.digest()) == (
        source.name,
        source.count(),
        source.digest(),
    )
    assert behind.metadata == {"run": "1"}
    assert {each.log_name for each in behind} == {"walk 0"}
    assert innermost(Relabelled(behind, label_map=LabelMap({"lab": "office"}))) is source


def test_nobody_writes_into_what_all_sources_share() -> None:
    with pytest.raises(TypeError, match="does not support item assignment"):
        Walk().metadata["run"] = "1"  # type: ignore[index]
    with pytest.raises(TypeError, match="does not support item assignment"):
        guarded(Walk()).metadata["run"] = "1"  # type: ignore[index]


def test_our_own_errors_pass() -> None:
    def refuse() -> None:
        raise DataError("a.csv: line 7 has no time")

    with pytest.raises(DataError, match=r"^a\.csv: line 7 has no time$"):
        list(guarded(Faulty(refuse)))


def test_what_is_no_source_is_left_alone() -> None:
    observations: Iterable[Observation] = [Walk().at(0)]
    assert guarded(observations) is observations
    once = guarded(Walk())
    assert isinstance(once, Guarded)
    assert guarded(once) is once
    assert isinstance(once, Source)
