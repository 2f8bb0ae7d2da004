"""The full parameter grid against scikit-learn's GridSearchCV: ``python benchmarks/training.py``.

CRFH and laser of 950 samples of a simulated office, from features; 10 C, 10 gammas, 5 folds, the
three multi-class extensions. ``--threads N`` shares the folds out among N threads.
"""

import argparse
import os
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from time import perf_counter
from typing import Any

import joblib
import numpy as np
from scipy import sparse
from sklearn.ensemble import AdaBoostClassifier
from sklearn.metrics.pairwise import chi2_kernel
from sklearn.model_selection import GridSearchCV, StratifiedKFold
from sklearn.multiclass import OneVsRestClassifier
from sklearn.svm import SVC

from placecue.features import FeatureBatch, stack
from placecue.scaling import QuantileScaling
from placecue_classifiers.adaboost import AdaBoost
from placecue_classifiers.svm import SVM
from placecue_cues.crfh import CRFH
from placecue_cues.laser import LaserGeometry
from placecue_kernels.chi2 import Chi2
from placecue_kernels.rbf import RBF
from placecue_office.simulator import Office

SAMPLES = 950
COSTS = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 3e4]
GAMMAS = {
    "crfh": np.geomspace(0.05, 50, 10).tolist(),
    "laser": np.geomspace(0.001, 1, 10).tolist(),
}
MULTICLASS = ["oao", "oaa", "modified_oaa"]
FOLDS = 5
ROUNDS = 100


def samples() -> tuple[dict[str, Any], np.ndarray]:
    """Histograms and laser features, and labels, of a drive through the office."""
    cues = {"crfh": CRFH(), "laser": LaserGeometry()}
    features: dict[str, list[Any]] = {name: [] for name in cues}
    labels: list[str] = []
    for observation in Office(rate=11.0):
        if observation.label is not None and len(labels) < SAMPLES:
            labels.append(observation.label)
            for name, cue in cues.items():
                features[name].append(cue.features(observation))
    return {name: stack(rows) for name, rows in features.items()}, np.array(labels)


def seconds(call: Callable[[], Any]) -> float:
    start = perf_counter()
    call()
    return perf_counter() - start


def ours(name: str, features: FeatureBatch, labels: np.ndarray) -> float:
    kernel = Chi2() if name == "crfh" else RBF()
    search = {"C": COSTS, "gamma": GAMMAS[name], "multiclass": MULTICLASS}
    svm = SVM(kernel, search=search, scaling=None if name == "crfh" else QuantileScaling())
    elapsed = seconds(lambda: svm.fit(features, labels))
    best = max(svm.search_["balanced_accuracy"])
    print(f"  placecue SVM, {len(svm.search_['C'])} points: {elapsed:8.2f} s ({100 * best:.1f} %)")
    return elapsed


def peer_laser(features: np.ndarray, labels: np.ndarray) -> float:
    """Time the peer on the whole grid: one-against-one, and one-against-all twice."""
    scaled = QuantileScaling().fit(features).transform(features)
    rest = OneVsRestClassifier(SVC(kernel="rbf", class_weight="balanced"))
    once = SVC(kernel="rbf", class_weight="balanced")
    elapsed = [
        seconds(lambda m=model, p=prefix: grid(m, p, GAMMAS["laser"]).fit(scaled, labels))
        for model, prefix in ((once, ""), (rest, "estimator__"))
    ]
    print(f"  peer, one-against-one {elapsed[0]:.1f} s, one-against-all {elapsed[1]:.1f} s (twice)")
    return elapsed[0] + 2 * elapsed[1]


def grid(model: Any, prefix: str, gammas: list[float]) -> GridSearchCV:
    values = {f"{prefix}C": COSTS, f"{prefix}gamma": gammas}
    return GridSearchCV(model, values, cv=StratifiedKFold(FOLDS), scoring="balanced_accuracy")


def peer_crfh(features: sparse.csr_array, labels: np.ndarray) -> dict[str, float]:
    """Time one point of the grid in one fold, and count how often the peer would come by it.

    scikit-learn computes the kernel anew for each C, gamma, fold and binary problem. Its own
    chi-squared kernel is dense: it is timed on a block. The same with placecue's kernel is given
    too, to tell what the kernel's speed does and what the search's.
    """
    train, test = next(StratifiedKFold(FOLDS).split(labels, labels))
    columns, places = np.unique(features.indices, return_inverse=True)
    shape = (features.shape[0], len(columns))
    narrow = sparse.csr_array((features.data, places.ravel(), features.indptr), shape=shape)
    block = narrow[:20].toarray()
    own = seconds(lambda: chi2_kernel(block)) / 400
    fast = seconds(lambda: Chi2(1.0).gram(features[train])) / len(train) ** 2
    gram = Chi2(1.0).gram(features)
    sides = len(np.unique(labels))
    within, across = gram[np.ix_(train, train)], gram[np.ix_(test, train)]
    svc = SVC(kernel="precomputed", class_weight="balanced")
    rest = OneVsRestClassifier(svc)
    solving = sum(
        seconds(lambda m=m: m.fit(within, labels[train]).predict(across)) for m in (svc, rest, rest)
    )
    # Kernel values for fitting and for scoring: once for all pairs, and once a class, twice.
    pairs = (1 + 2 * sides) * (within.size + across.size)
    points = FOLDS * len(COSTS) * len(GAMMAS["crfh"])
    return {
        "SVC(kernel=chi2_kernel)": points * (solving + pairs * own),
        "SVC(kernel=Chi2().gram)": points * (solving + pairs * fast),
        "SVC(kernel='precomputed'), Gram matrices free": points * solving,
    }


def boosting(features: np.ndarray, labels: np.ndarray) -> None:
    AdaBoost(rounds=1).fit(features[::10], labels[::10])
    mine = seconds(lambda: AdaBoost(rounds=ROUNDS).fit(features, labels))
    peer = OneVsRestClassifier(AdaBoostClassifier(n_estimators=ROUNDS, random_state=0))
    theirs = seconds(lambda: peer.fit(features, labels))
    print(f"AdaBoost, {ROUNDS} rounds, {features.shape[1]} features, one thread")
    print(f"  peer, AdaBoostClassifier against the rest: {theirs:.2f} s")
    print(f"  placecue AdaBoost: {mine:.2f} s, {theirs / mine:.0f}x")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=1)
    threads = parser.parse_args().threads
    features, labels = samples()
    print(f"{len(labels)} samples of {len(np.unique(labels))} classes; {threads} thread(s)")
    warm = np.arange(len(labels)) % 10 == 0
    Chi2().shared(features["crfh"][warm])  # compiles
    print("CRFH")
    with joblib.parallel_config(n_jobs=threads):
        crfh = ours("crfh", features["crfh"], labels)
    peers = peer_crfh(features["crfh"], labels)
    for name, elapsed in peers.items():
        print(f"  peer, {name}: {elapsed:8.0f} s (from one point), {elapsed / crfh:.1f}x")
    print("laser")
    with joblib.parallel_config(n_jobs=threads):
        laser = ours("laser", features["laser"], labels)
    peer = peer_laser(features["laser"], labels)
    print(f"  peer, GridSearchCV(SVC(kernel='rbf')): {peer:8.1f} s, {peer / laser:.1f}x")
    print("CRFH and laser")
    for name, elapsed in peers.items():
        ratio = (elapsed + peer) / (crfh + laser)
        print(f"  {crfh + laser:.1f} s against {name}: {elapsed + peer:.0f} s, {ratio:.1f}x")
    boosting(features["laser"], labels)


if __name__ == "__main__":
    main()
