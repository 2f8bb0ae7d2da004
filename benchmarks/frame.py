"""One frame from decoded image and scan to belief: ``python benchmarks/frame.py``.

CRFH + SIFT + laser, each with an SVM, and SVM-DAS, as shipped but for the search. 950 frames of
the simulated office are trained on; others are asked for one at a time, as a robot does. Then the
same by confidence-based integration, which extracts what it needs. On one thread, or as many as
OMP_NUM_THREADS says.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from collections import Counter
from dataclasses import replace
from time import perf_counter

import cv2
import numpy as np
from sklearn.metrics import balanced_accuracy_score

from placecue import Cue, Observation, Pipeline
from placecue.classifier import Classifier
from placecue.features import n_samples
from placecue.learning.costs import measured
from placecue.scaling import FamilyScaling
from placecue_classifiers.svm import SVM
from placecue_cues.crfh import CRFH
from placecue_cues.laser import LaserGeometry
from placecue_cues.sift import SIFT
from placecue_integrators.confidence import Confidence
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.chi2 import Chi2
from placecue_kernels.match import Match
from placecue_kernels.rbf import RBF
from placecue_office.simulator import Office

THREADS = int(os.environ["OMP_NUM_THREADS"])
#: Samples a second that make 950 training frames of a drive, and fewer of other drives.
TRAINING, INTEGRATION, ASKED, SCORED = 11.33, 1.5, 0.7, 2.0


def cues() -> dict[str, tuple[Cue, Classifier]]:
    return {
        "crfh": (CRFH(), SVM(kernel=Chi2())),
        "sift": (SIFT(), SVM(kernel=Match())),
        "laser": (LaserGeometry(), SVM(kernel=RBF(gamma=0.1), scaling=FamilyScaling())),
    }


def drive(run: int, rate: float) -> list[Observation]:
    """A drive through the office, its images decoded."""
    found = []
    for each in Office(run=run, rate=rate):
        _ = each.image
        found.append(each)
    return found


def milliseconds(pipeline: Pipeline, asked: list[Observation]) -> list[float]:
    for each in asked[:3]:
        pipeline.believe([each])
    times = []
    for each in asked:
        start = perf_counter()
        pipeline.believe([each])
        times.append(1e3 * (perf_counter() - start))
    return times


def trained(names: tuple[str, ...], training: list[Observation]) -> Pipeline:
    """A pipeline whose integrator learns on another drive."""
    chosen = cues()
    return Pipeline(
        {name: chosen[name] for name in names},
        SVMDAS(classifier=SVM(kernel=RBF(), multiclass="oao")),
    ).fit(training, drive(3, INTEGRATION))


def report(pipeline: Pipeline, asked: list[Observation]) -> None:
    for name, model in pipeline.cues.items():
        cue, classifier = model.cue, model.classifier
        kept = n_samples(classifier.support_features_)
        times = []
        for each in asked:
            start = perf_counter()
            features = cue.transform([each])
            middle = perf_counter()
            classifier.scores(features)
            times.append((middle - start, perf_counter() - middle))
        extract, score = 1e3 * np.median(times, axis=0)
        print(f"{name:6} extract {extract:5.1f} ms, score {score:5.1f} ms, {kept} support vectors")
    times = milliseconds(pipeline, asked)
    print(
        f"{' + '.join(pipeline.cues)} + SVM-DAS: median {np.median(times):.1f} ms a frame, "
        f"fastest {min(times):.1f}"
    )


def staged(full: Pipeline, training: list[Observation]) -> Pipeline:
    """The same cues, asked one after the other."""
    assert full.held_out_ is not None
    fitted_on = replace(full.held_out_, costs=measured(full.cues, training))
    staged = Pipeline(full.cues, Confidence(SVMDAS(full.integrator.classifier)))  # type: ignore[attr-defined]
    return staged.fit_integrator(fitted_on)


def compare(full: Pipeline, staged: Pipeline, asked: list[Observation]) -> None:
    """Print the mean time a frame of both, and how much they recognise."""
    means, rates = [], []
    for pipeline in (full, staged):
        means.append(np.mean(milliseconds(pipeline, asked)))
        said = [pipeline.believe([each])[0].label for each in asked]
        rates.append(100 * balanced_accuracy_score([each.label for each in asked], said))
    used = Counter(cue for each in asked for cue in staged.believe([each])[0].cues_used)
    print(
        f"confidence: mean {means[1]:.1f} ms a frame of {len(asked)}, all cues {means[0]:.1f}, "
        f"{100 * means[1] / means[0]:.0f} % (aims: at most 40 %, 15 ms); "
        f"{rates[1]:.1f} % right, all cues {rates[0]:.1f} (aim: within 0.5)"
    )
    print("used: " + ", ".join(f"{cue} {100 * n / len(asked):.0f} %" for cue, n in used.items()))
    print(staged.integrator.summary())


def main() -> None:
    cv2.setNumThreads(THREADS)
    training, asked = drive(1, TRAINING), drive(2, ASKED)
    print(f"{THREADS} threads, {len(training)} training frames")
    for names in (("crfh", "laser"), ("crfh", "sift", "laser")):
        pipeline = trained(names, training)
        report(pipeline, asked)
    compare(pipeline, staged(pipeline, training), drive(2, SCORED))


if __name__ == "__main__":
    main()
