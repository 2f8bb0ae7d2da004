"""Configs become components and components become configs."""

from collections.abc import Mapping, Sequence

import pytest
from omegaconf import OmegaConf

from placecue import Blocks, Boundary, Component, Cue, Kernel, UsageError
from placecue.components.build import build, describe
from placecue.components.pipelines import build_pipeline, components_of, describe_pipeline
from placecue.components.registry import Registry
from placecue.scaling import QuantileScaling, RangeScaling, Scaling
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from toys import Beams, pipeline, registry


@pytest.fixture(scope="module")
def known() -> Registry:
    return registry()


def test_components_nest(known: Registry) -> None:
    spec = OmegaConf.create(
        {"gamma": 0.5, "svm": {"plugin": "svm", "kernel": {"plugin": "rbf", "gamma": "${gamma}"}}}
    )
    svm = build(spec.svm, "classifier", known)
    assert isinstance(svm, SVM)
    assert isinstance(svm.kernel, RBF)
    assert svm.kernel.gamma == 0.5


def test_lists_and_mappings_arrive_as_plain_python(known: Registry) -> None:
    spec = OmegaConf.create({"plugin": "svm", "search": {"C": [1, 2]}})
    search = build(spec, "classifier", known).search
    assert type(search) is dict
    assert type(search["C"]) is list


def test_describe_is_the_opposite_of_build(known: Registry) -> None:
    svm = SVM(kernel=RBF(gamma=0.25), C=3.0, multiclass="oao", search={"C": [1.0]})
    again = build(describe(svm, known), "classifier", known)
    assert describe(again, known) == describe(svm, known)


def test_a_whole_pipeline_is_built_anew(known: Registry) -> None:
    composition = describe_pipeline(pipeline(), known)
    assert describe_pipeline(build_pipeline(composition, known), known) == composition


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ({"plugin": "swm"}, "unknown classifier 'swm'; did you mean 'svm'"),
        ({"plugin": "svm", "c": 1}, "has no parameter 'c'; did you mean|has no parameter 'c'; ava"),
        ({"plugin": "svm", "kernel": {"plugin": "rbff"}}, "unknown kernel 'rbff'"),
        ({"plugin": "svm", "kernel": {"plugin": "rbf", "gama": 1}}, r"classifier\.kernel: .*gamma"),
        ({"plugin": "svm", "C": {"plugin": "nothing"}}, "cannot tell what kind"),
        ({"kernel": 1}, "must be a mapping with 'plugin'"),
        (None, "must be a mapping with 'plugin'"),
    ],
)
def test_mistakes_are_answered_with_what_exists(
    known: Registry, spec: object, message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        build(spec, "classifier", known)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("block", "unknown folds 'block'; did you mean 'blocks'"),
        ({"plugin": "blocks", "seconds": 2}, "folds 'blocks' has no parameter 'seconds'"),
        ({"plugin": "blocks", "n_folds": 1}, r"folds\.n_folds must be 2 or more, got 1"),
        ({"plugin": "blocks", "n_folds": "many"}, "n_folds must be a whole number, got 'many'"),
        ({"plugin": "interleaved", "seconds": "2 s"}, "seconds must be a number, got '2 s'"),
        ({"plugin": "interleaved", "seconds": 0}, r"folds\.seconds must be above 0, got 0"),
        ({"plugin": "by_log", "only_last": 1}, "only_last must be true or false, got 1"),
        (3, "folds must be a mapping with 'plugin' and parameters, got 3; available: blocks"),
    ],
)
def test_mistakes_in_folds_are_named(known: Registry, spec: object, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        build(spec, "folds", known)


def test_a_name_stands_for_a_component_with_its_defaults(known: Registry) -> None:
    spec = {
        "plugin": "svm",
        "kernel": {"plugin": "sum", "kernels": ["linear", {"plugin": "rbf", "gamma": 0.5}]},
        "scaling": "quantiles",
        "folds": "blocks",
        "search": {"scaling": ["range", None], "kernel__kernels__1__gamma": [0.1, 1]},
    }
    svm = build(spec, "classifier", known)
    assert type(svm.scaling) is QuantileScaling
    assert type(svm.folds) is Blocks
    assert [type(each).__name__ for each in svm.kernel.kernels] == ["Linear", "RBF"]
    tried, none = svm.search["scaling"]
    assert type(tried) is RangeScaling
    assert none is None
    described = describe(svm, known)
    assert described["search"]["scaling"] == [{"plugin": "range"}, None]
    assert described["folds"] == {"plugin": "blocks", "n_folds": 5}
    assert describe(build(described, "classifier", known), known) == described


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"scaling": "quantile"}, "unknown scaling 'quantile'; did you mean 'quantiles'"),
        ({"search": {"scaling": ["rang"]}}, "unknown scaling 'rang'; did you mean 'range'"),
        ({"kernel": {"plugin": "sum", "kernels": ["rbff"]}}, "unknown kernel 'rbff'"),
    ],
)
def test_a_name_that_is_none_is_answered_with_what_exists(
    known: Registry, change: dict[str, object], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        build({"plugin": "svm", "kernel": "rbf", **change}, "classifier", known)


def test_what_is_null_in_a_search_is_not_searched(known: Registry) -> None:
    spec = {"plugin": "svm", "kernel": "rbf", "search": {"C": [1, 2], "gamma": None}}
    assert build(spec, "classifier", known).search == {"C": [1, 2]}


# ------------------------------------------------------------------ components of one's own


class Alike(Kernel):
    """Has the name of a cue, and a text under a parameter that is named as a kind."""

    def __init__(self, source: str = "rbf", layout=None) -> None:  # type: ignore[no-untyped-def]
        self.source, self.layout = source, layout

    def gram(self, a, b=None):  # type: ignore[no-untyped-def]
        raise NotImplementedError


class Parts(Beams):
    """A cue made of cues."""

    def __init__(
        self,
        parts: Sequence[Cue] = (),
        named: Mapping[str, Cue] | None = None,
        free=None,  # type: ignore[no-untyped-def]
        scalings: Sequence[Scaling] = (),
        boundaries: Mapping[str, Boundary] | None = None,
    ) -> None:
        self.parts, self.named, self.free = parts, named, free
        self.scalings, self.boundaries = scalings, boundaries


@pytest.fixture(scope="module")
def own() -> Registry:
    found = registry()
    mine = [
        Component("cue", "parts", f"{__name__}:Parts"),
        Component("kernel", "crfh", f"{__name__}:Alike"),
        Component("kernel", "alike", f"{__name__}:Alike"),
    ]
    found.add(mine, "mine", "1")
    return found


def test_components_stand_in_lists_and_mappings(own: Registry) -> None:
    spec = {
        "plugin": "parts",
        "parts": ["crfh", {"plugin": "beams", "count": 2}],
        "named": {"a": "crfh", "b": {"plugin": "parts", "parts": ["laser"]}},
        "free": {"deep": [{"plugin": "rbf", "gamma": 0.5}, 3]},
        "scalings": ["range", {"plugin": "quantiles", "n_quantiles": 9}],
        "boundaries": {"first": "door"},
    }
    cue = build(spec, "cue", own)
    assert [type(each).__name__ for each in cue.parts] == ["CRFH", "Beams"]
    assert type(cue.named["b"].parts[0]).__name__ == "LaserGeometry"
    assert cue.free["deep"][0].gamma == 0.5
    assert cue.free["deep"][1] == 3
    assert cue.scalings[1].n_quantiles == 9
    assert type(cue.boundaries["first"]).__name__ == "Door"
    described = describe(cue, own)
    assert described["parts"][1] == {"plugin": "beams", "count": 2}
    assert described["named"]["b"]["parts"][0]["plugin"] == "laser"
    assert described["free"]["deep"][0] == {"plugin": "rbf", "gamma": 0.5}
    assert describe(build(described, "cue", own), own) == described


def test_two_kinds_may_have_one_name(own: Registry) -> None:
    both = build({"plugin": "svm", "kernel": "crfh"}, "classifier", own)
    assert type(both.kernel) is Alike
    assert type(build({"plugin": "parts", "parts": ["crfh"]}, "cue", own).parts[0]) is not Alike
    with pytest.raises(UsageError, match="it is a cue and a kernel"):
        build({"plugin": "parts", "free": {"plugin": "crfh"}}, "cue", own)


def test_a_text_stays_one_where_a_parameter_takes_text(own: Registry) -> None:
    assert build({"plugin": "alike", "source": "mcap"}, "kernel", own).source == "mcap"
    # Nothing is said of this one: a text that names no layout is left alone.
    assert build({"plugin": "alike", "layout": "wide"}, "kernel", own).layout == "wide"


def test_every_component_of_a_pipeline_is_named(known: Registry) -> None:
    composition = describe_pipeline(pipeline(), known)
    composition["folds"] = {"plugin": "by_log"}
    named = set(components_of(composition, known))
    assert ("folds", "by_log") in named
    assert ("scaling", "range") in named
    assert ("kernel", "rbf") in named
    assert ("integrator", "svm_das") in named
