"""Machines that LIBSVM does not finish are told in one line, and Ctrl-C ends their training."""

from __future__ import annotations

import logging
import signal
import subprocess
import sys
import warnings

import numpy as np
import pytest
from joblib import parallel_config

from placecue import StandardScaling
from placecue_classifiers import convergence
from placecue_classifiers.machines import one_against_all, one_against_one
from placecue_classifiers.svm import SVM
from placecue_kernels.linear import Linear
from placecue_kernels.rbf import RBF

NAMES = np.array(["corridor", "kitchen", "lab", "office"])


def rooms(scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Four rooms that cannot be told apart, in features of a large scale."""
    rng = np.random.default_rng(3)
    return scale * rng.normal(size=(80, 5)), NAMES[np.arange(80) % 4]


@pytest.fixture
def few_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(convergence, "ITERATIONS", 2000)
    monkeypatch.setattr(convergence, "ITERATIONS_PER_SAMPLE", 1)


def warned(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [each.getMessage() for each in caplog.records if each.levelno == logging.WARNING]


@pytest.mark.usefixtures("few_iterations")
def test_a_training_tells_once_what_did_not_converge(caplog: pytest.LogCaptureFixture) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # scikit-learn's own would be one a machine
        SVM(Linear(), C=100.0).fit(*rooms(1e4))
    assert warned(caplog) == [
        "LIBSVM stopped 4 of 4 machines after 2000 iterations, before they converged: corridor "
        "against the rest, kitchen against the rest, lab against the rest and 1 more, at C=100; "
        "scale the features (scaling), or choose a smaller C or another kernel"
    ]


@pytest.mark.usefixtures("few_iterations")
@pytest.mark.parametrize("n_jobs", [1, 2])
def test_so_does_a_search_over_all_its_folds(caplog: pytest.LogCaptureFixture, n_jobs: int) -> None:
    search = {"C": [1.0, 1e7], "multiclass": ["oao"]}
    with parallel_config(backend="threading", n_jobs=n_jobs):
        SVM(Linear(), search=search, scaling=StandardScaling()).fit(*rooms(1.0))
    [line] = warned(caplog)
    # Two values of C in five folds and the final training, six pairs each.
    assert "of 66 machines after 2000 iterations" in line
    assert "corridor against kitchen, corridor against lab, corridor against office" in line
    assert "at C=1e+07; scale" in line


def test_ordinary_machines_are_far_from_the_limit(caplog: pytest.LogCaptureFixture) -> None:
    features, labels = rooms(1.0)
    for kernel in (RBF(0.05), Linear()):
        SVM(kernel, C=100.0, scaling=StandardScaling()).fit(features, labels)
    assert warned(caplog) == []
    assert convergence.iteration_limit(80) == 2_000_000
    assert convergence.iteration_limit(20_000) == 10_000_000


@pytest.mark.usefixtures("few_iterations")
def test_outside_of_a_training_classes_go_by_their_numbers(
    caplog: pytest.LogCaptureFixture,
) -> None:
    features, labels = rooms(1e4)
    codes = np.unique(labels, return_inverse=True)[1]
    for train in (one_against_all, one_against_one):
        train(features @ features.T, codes, 100.0, None)
    assert "converged: 0 against the rest, 1 against the rest" in warned(caplog)[0]
    assert "converged: 0 against 1, 0 against 2" in warned(caplog)[1]


#: Trains machines which LIBSVM cannot finish within minutes.
ENDLESS = """
import signal
import numpy as np
from joblib import parallel_config
from placecue_classifiers import convergence
from placecue import StandardScaling
from placecue_classifiers.svm import SVM
from placecue_kernels.linear import Linear

# Shells let commands in the background ignore it, and so would what they start.
signal.signal(signal.SIGINT, signal.default_int_handler)
convergence.ITERATIONS = 2**31 - 1
features = 1e4 * np.random.default_rng(0).normal(size=(400, 30))
print("begun", flush=True)
try:
    with parallel_config(backend="threading", n_jobs={n_jobs}):
        SVM(Linear(), C=1e6, search={search}).fit(features, np.arange(400) % 4)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
@pytest.mark.parametrize(("search", "n_jobs"), [(None, 1), ({"C": [1e6, 1e7]}, 2)])
def test_ctrl_c_ends_a_training_that_would_go_on(
    search: dict[str, list[float]] | None, n_jobs: int
) -> None:
    script = ENDLESS.format(search=search, n_jobs=n_jobs)
    with subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "begun\n"
            with pytest.raises(subprocess.TimeoutExpired):  # until LIBSVM surely is at work
                process.wait(timeout=2)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=60)
        finally:
            process.kill()
    assert (out, process.returncode) == ("interrupted\n", 0), err
