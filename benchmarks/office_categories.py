"""Office, corridor and kitchen of one simulated building, recognised in another one.

python benchmarks/office_categories.py
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from sklearn.metrics import balanced_accuracy_score, recall_score

from placecue.evidence import StoredEvidence
from placecue.learning.collecting import collect
from placecue.observation import Observation
from placecue.pipeline import Pipeline
from placecue.scaling import QuantileScaling
from placecue.scores import Scores
from placecue_classifiers.svm import SVM
from placecue_cues.crfh import CRFH
from placecue_cues.laser import LaserGeometry
from placecue_integrators.svm_das import SVMDAS
from placecue_kernels.chi2 import Chi2
from placecue_kernels.rbf import RBF
from placecue_office.simulator import Office

#: Categories that both buildings have; other rooms are left out.
CATEGORIES = {
    "one_person_office": "office",
    "two_person_office": "office",
    "office": "office",
    "corridor": "corridor",
    "kitchen": "kitchen",
}
RECORDINGS = [(0, "cloudy", 1), (1, "night", 2), (2, "sunny", 3)]


def drives(world: str, every: int = 2) -> Iterator[Observation]:
    """Yield the observations of three worlds in three lights, by category."""
    for number, (seed, light, run) in enumerate(RECORDINGS):
        start = 1.7e9 + 10_000 * number
        office = Office(world=world, seed=seed, illumination=light, run=run, start=start)
        for index, each in enumerate(office):
            if index % every == 0 and each.label in CATEGORIES:
                yield each.relabelled(CATEGORIES[each.label])


def main() -> None:
    """Train in ``idol2_floor``, test in ``second_floor``, print recalls."""
    laser = SVM(kernel=RBF(gamma=0.01), C=10.0, scaling=QuantileScaling())
    pipeline = Pipeline(
        cues={
            "crfh": (CRFH(), SVM(kernel=Chi2(gamma=1.0), C=10.0)),
            "laser": (LaserGeometry(preset="full"), laser),
        },
        integrator=SVMDAS(SVM(kernel=RBF(gamma=0.5), C=10.0, multiclass="oao")),
    ).fit(drives("idol2_floor"))
    samples = collect(
        drives("second_floor"), {name: model.cue for name, model in pipeline.cues.items()}
    )
    scores: dict[str, Scores] = {
        name: model.scores(samples.extracted[name].features[0])
        for name, model in pipeline.cues.items()
    }
    scores["svm_das"] = pipeline.integrator.integrate(StoredEvidence(dict(scores)))
    classes = np.unique(samples.labels)
    print(f"{len(samples)} samples; recalls of {', '.join(classes)}")
    for name, of_method in scores.items():
        decided = of_method.decide().labels
        recalls = recall_score(samples.labels, decided, labels=classes, average=None)
        mean = balanced_accuracy_score(samples.labels, decided)
        print(f"{name:8} {100 * mean:5.1f}  {np.round(100 * recalls, 1)}")


if __name__ == "__main__":
    main()
