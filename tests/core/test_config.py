"""Configs become components and components become configs."""

import pytest
from omegaconf import OmegaConf

from placecue import Blocks, UsageError
from placecue.components.build import build, describe
from placecue.components.pipelines import build_pipeline, describe_pipeline
from placecue.components.registry import Registry
from placecue.folds import fold_scheme
from placecue_classifiers.svm import SVM
from placecue_kernels.rbf import RBF
from toys import pipeline, registry


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


def test_fold_schemes_by_name() -> None:
    assert fold_scheme({"scheme": "blocks", "n_folds": 3}) == Blocks(n_folds=3)
    with pytest.raises(UsageError, match="did you mean 'blocks'"):
        fold_scheme({"scheme": "block"})
    with pytest.raises(UsageError, match="no parameter 'seconds'"):
        fold_scheme({"scheme": "blocks", "seconds": 3})
