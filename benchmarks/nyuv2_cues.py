"""Every cue as shipped, alone, on real rooms: ``python benchmarks/nyuv2_cues.py [CUE ...]``.

Four rooms of NYU Depth v2 (``PLACECUE_DATA``), nested blocked cross-validation: each fifth of a
room's frames, in their order, is scored by models that saw the other four fifths; C and gamma are
searched inside these. Nothing is chosen on what is scored. Rooms are never seen twice.
"""

import csv
import os
import sys
from pathlib import Path
from time import perf_counter

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import cv2
import numpy as np
from hydra import compose, initialize_config_module
from sklearn.base import clone
from sklearn.metrics import recall_score

from placecue import Blocks, Cue, Observation
from placecue.classifier import Classifier
from placecue.composition import build_pipeline
from placecue.config import plain
from placecue.discovery.manager import load_plugins
from placecue.discovery.options import register_with_hydra
from placecue.features import FeatureBatch, take
from placecue.observation import EncodedImage
from placecue.virtual_scan import Intrinsics, virtual_scan

ROOMS = ("bathroom", "bedroom", "kitchen", "living_room")
#: Kinect of the data set, and metres a grey level of its 8-bit depth.
CAMERA, METRES = Intrinsics(519.0, 325.6, 253.7), 1 / 25.5
#: What a quick prototype reached, percent (METHODS.md, section 7).
PROTOTYPE = {
    "crfh": 37,
    "sift": 43,
    "laser": 50,
    "color_histogram": 46,
    "gist": 46,
    "fisher_vector": 55,
}
CUES = (*PROTOTYPE, "bag_of_words")
SECOND = 1_000_000_000


def frames(folder: Path) -> list[Observation]:
    """Frames of the four rooms, one a second."""
    found = []
    with (folder / "labels.csv").open() as file:
        for row in csv.DictReader(file):
            if row["room"] not in ROOMS:
                continue
            depth = cv2.imread(str(folder / row["depth"]), cv2.IMREAD_UNCHANGED) * METRES
            image = EncodedImage((folder / row["rgb"]).read_bytes())
            scan = virtual_scan(depth, CAMERA)
            found.append(
                Observation(len(found) * SECOND, image=image, scan=scan, label=row["room"])
            )
    return found


def as_shipped(name: str) -> tuple[Cue, Classifier]:
    """The cue and classifier of an option file; its search cut into blocks too."""
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        overrides = [f"cue=[{name}]", "integrator=none", "log=none"]
        overrides.append(f"cues.{name}.classifier.folds.scheme=blocks")
        config = plain(compose("train", overrides))
    return build_pipeline(config, load_plugins(built_ins_only=True).registry).cues[name]


def fresh(observations: list[Observation]) -> list[Observation]:
    """The same, so that decoded images are not kept."""
    return [each.relabelled(each.label) for each in observations]


def accuracy(cue: Cue, classifier: Classifier, observations: list[Observation]) -> float:
    """Balanced accuracy over all held-out frames, percent."""
    labels = np.array([each.label for each in observations])
    stamps = np.array([each.stamp for each in observations])
    predicted = np.empty_like(labels)
    features: FeatureBatch | None = None
    for training, held_out in Blocks(n_folds=5).split(labels):
        if cue.learns or features is None:
            learned: Cue = clone(cue).fit(fresh([observations[i] for i in training]))
            features = learned.transform(fresh(observations))
        model = clone(classifier).fit(take(features, training), labels[training], stamps[training])
        predicted[held_out] = model.scores(take(features, held_out)).decide().labels
    return 100 * float(recall_score(labels, predicted, average="macro"))


def main() -> None:
    if "PLACECUE_DATA" not in os.environ:
        raise SystemExit("PLACECUE_DATA is not set: it names the folder of recorded data")
    observations = frames(Path(os.environ["PLACECUE_DATA"]) / "nyuv2")
    print(f"{len(observations)} frames of {', '.join(ROOMS)}; balanced accuracy, percent")
    print(f"{'cue':16} {'placecue':>8} {'prototype':>9} {'seconds':>8}")
    for name in sys.argv[1:] or CUES:
        start = perf_counter()
        percent = accuracy(*as_shipped(name), observations)
        known = str(PROTOTYPE.get(name, "-"))
        print(f"{name:16} {percent:8.1f} {known:>9} {perf_counter() - start:8.0f}", flush=True)


if __name__ == "__main__":
    main()
