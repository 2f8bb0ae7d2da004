"""scikit-learn's own checks pass on dense input; checks.py has those that cannot apply."""

from typing import Any

from sklearn.utils.estimator_checks import parametrize_with_checks

from classifiers.checks import cannot_apply
from placecue.scaling import StandardScaling
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.boosted_trees import BoostedTrees
from placecue_classifiers.grid_search import GridSearch
from placecue_classifiers.nearest_mean import NearestMean
from placecue_classifiers.scikit_learn import ScikitLearn
from placecue_classifiers.svm import SVM
from placecue_kernels.hi import HistogramIntersection
from placecue_kernels.linear import Linear
from placecue_kernels.rbf import RBF

CLASSIFIERS = [
    SVM(kernel=RBF(gamma=0.5)),
    SVM(kernel=RBF(gamma=0.5), multiclass="oao"),
    SVM(kernel=RBF(gamma=0.5), multiclass="modified_oaa"),
    SVM(kernel=RBF(gamma=0.5), multiclass="oao", probability="isotonic"),
    SVM(kernel=RBF(), search={"C": [1, 100], "gamma": [0.1, 0.5]}, scaling=StandardScaling()),
    SVM(kernel=HistogramIntersection()),
    SVM(kernel=Linear()),
    NearestMean(),
    NearestMean("shared"),
    AdaBoost(rounds=20),
    AdaBoost(rounds=20, output="probability"),
    AdaBoost(rounds=20, criterion="gini"),
    BoostedTrees(rounds=3, learning_rate=0.5, leaf_samples=1),
    GridSearch(AdaBoost(rounds=10), search={"rounds": [5, 10]}),
    ScikitLearn("sklearn.naive_bayes.GaussianNB"),
    ScikitLearn("sklearn.linear_model.RidgeClassifier"),
]


@parametrize_with_checks(CLASSIFIERS, expected_failed_checks=cannot_apply)
def test_scikit_learn_check(estimator: Any, check: Any) -> None:
    check(estimator)
