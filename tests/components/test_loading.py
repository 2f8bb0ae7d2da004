"""Our loader: one entry point at a time, broken and clashing plugins reported."""

import sys
import types
from importlib.metadata import Distribution, EntryPoint, entry_points

import pytest

from placecue import Component, PluginError, UsageError, hookimpl
from placecue.components.manager import load_plugins


class FakeDistribution(Distribution):
    def __init__(self, name: str) -> None:
        self._name = name

    def read_text(self, filename: str) -> str | None:
        return f"Name: {self._name}\nVersion: 2.5\n" if filename == "METADATA" else None

    def locate_file(self, path):  # type: ignore[no-untyped-def]
        raise FileNotFoundError(path)


def plugin(monkeypatch: pytest.MonkeyPatch, distribution: str, **functions: object) -> EntryPoint:
    module = types.ModuleType(f"fake_{distribution}")
    for name, function in functions.items():
        setattr(module, name, hookimpl(function))
    monkeypatch.setitem(sys.modules, module.__name__, module)
    entry_point = EntryPoint("extra", module.__name__, "placecue")
    return entry_point._for(FakeDistribution(distribution))  # type: ignore[attr-defined]


def brings(*components: Component):  # type: ignore[no-untyped-def]
    return lambda: list(components)


CRFH_TOO = Component("cue", "crfh", "somewhere.else:CRFH")


def test_built_ins_come_through_the_same_door() -> None:
    names = {each.value for each in entry_points(group="placecue") if each.dist.name == "placecue"}
    assert {"placecue_cues", "placecue_kernels", "placecue_sources", "placecue.logs"} <= names
    registry = load_plugins(built_ins_only=True).registry
    assert "crfh" in registry.names("cue")
    assert not registry.problems


def test_every_built_in_can_be_imported_and_has_a_summary() -> None:
    registry = load_plugins(built_ins_only=True).registry
    for each in registry:
        assert registry.load(each.component.kind, each.component.name) is not None
        assert each.component.summary
        assert (each.distribution, each.version) == ("placecue", "0.1.0")


def test_a_broken_plugin_is_listed_and_does_not_stop_the_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    missing = EntryPoint("gone", "no_such_module_anywhere", "placecue")
    good = plugin(monkeypatch, "good", placecue_components=brings(Component("cue", "c", "m:C")))
    registry = load_plugins([missing._for(FakeDistribution("broken")), good]).registry  # type: ignore[attr-defined]
    assert registry.names("cue") == ["c"]
    [problem] = registry.problems
    assert (problem.distribution, problem.version) == ("broken", "2.5")
    assert "ModuleNotFoundError" in problem.error


@pytest.mark.parametrize(
    ("functions", "message"),
    [
        ({"placecue_components": lambda wrong: []}, "PluginValidationError"),
        ({"placecue_componets": lambda: []}, "PluginValidationError"),
        ({"placecue_components": lambda: [Component("sensor", "x", "m:X")]}, "unknown kind"),
        ({"placecue_components": lambda: [Component("cue", "x", "m.X")]}, "import string"),
        ({"placecue_components": lambda: sys.exit(3)}, "SystemExit"),
        ({"placecue_components": lambda: 1 / 0}, "ZeroDivisionError"),
    ],
)
def test_wrong_plugins_are_listed(
    monkeypatch: pytest.MonkeyPatch, functions: dict, message: str
) -> None:
    registry = load_plugins([plugin(monkeypatch, "wrong", **functions)]).registry
    [problem] = registry.problems
    assert message in problem.error
    assert "\n" not in problem.error
    assert list(registry) == []


def test_two_plugins_of_one_name_are_an_error_that_names_both(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = plugin(monkeypatch, "alpha", placecue_components=brings(CRFH_TOO))
    second = plugin(monkeypatch, "beta", placecue_components=brings(CRFH_TOO))
    registry = load_plugins([first, second]).registry
    with pytest.raises(PluginError, match=r"alpha 2\.5 and beta 2\.5"):
        registry.get("cue", "crfh")


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    registry = load_plugins(built_ins_only=True).registry
    with pytest.raises(UsageError, match="did you mean 'crfh'"):
        registry.get("cue", "crhf")


def test_a_component_that_cannot_be_imported_keeps_its_cause(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lost = Component("cue", "lost", "no_such_module_anywhere:Cue")
    registry = load_plugins(
        [plugin(monkeypatch, "gamma", placecue_components=brings(lost))]
    ).registry
    with pytest.raises(PluginError, match=r"gamma 2\.5.*no_such_module") as caught:
        registry.load("cue", "lost")
    assert isinstance(caught.value.__cause__, ModuleNotFoundError)


def test_plugins_are_told_of_events(monkeypatch: pytest.MonkeyPatch) -> None:
    heard = []
    listener = plugin(
        monkeypatch,
        "ears",
        placecue_run_finished=lambda command: heard.append(command),
        placecue_area_labelled=lambda update: 1 / 0,
    )
    plugins = load_plugins([listener])
    plugins.tell("run_finished", command="train", out=None)
    assert heard == ["train"]
    with pytest.raises(PluginError, match="ears:extra failed on area_labelled"):
        plugins.tell("area_labelled", update=None)
