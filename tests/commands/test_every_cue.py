"""Each cue alone is a working system, whatever form the images have."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import succeeds
from placecue import Observation
from placecue.observation import EncodedImage
from results import rows
from rooms import ROOMS, Rooms, write_log

#: Of the costs that are tried.
FEW = "classifier.search.C=[10]"
#: What suits few small pictures.
SMALL = {
    "sift": ["contrast_threshold=0.01", FEW],
    "dense_sift": ["step=8", "cells=[3]", "classifier.search={C: [10], gamma: [1]}"],
    "fisher_vector": ["components=12", "gaussians=8", "sample=3000", FEW],
    "bag_of_words": ["words=30", "sample=3000", FEW],
}
CUES = (
    "crfh",
    "sift",
    "dense_sift",
    "laser",
    "gist",
    "color_histogram",
    "fisher_vector",
    "bag_of_words",
    "lite0",
)


class Photographed(Rooms):
    """The rooms, each of another brightness, in pictures of four forms in turn."""

    def at(self, number: int) -> Observation:
        seen = super().at(number)
        room = list(ROOMS).index(str(seen.label))
        grey = np.clip(np.asarray(seen.image) * 0.8 + 20 * room, 0, 255).astype(np.uint8)
        forms = (
            grey,
            np.repeat(grey[:, :, None], 3, axis=2),
            grey.astype(np.uint16) * 257,
            np.pad(grey, ((6, 6), (8, 8)), mode="symmetric"),
        )
        _, png = cv2.imencode(".png", forms[number % 4])
        image = EncodedImage(png.tobytes(), "png")
        return Observation(
            seen.stamp, image=image, scan=seen.scan, pose=seen.pose, label=seen.label
        )


@pytest.fixture(scope="module")
def photographed(shared: Path) -> tuple[Path, Path]:
    """A log to train on, and another one of the same rooms."""
    first, second = (Photographed(seed=seed) for seed in (0, 1))
    return write_log(shared / "p0.mcap", first), write_log(shared / "p1.mcap", second)


@pytest.mark.parametrize("cue", CUES)
def test_a_cue_alone(tmp_path: Path, photographed: tuple[Path, Path], cue: str) -> None:
    training, asked = photographed
    small = [f"cues.{cue}.{word}" for word in SMALL.get(cue, [FEW])]
    one = [f"cue={cue}", "integrator=none"]
    succeeds("train", *one, f"log={training}", f"out={tmp_path / 'm'}", *small)
    succeeds("classify", f"model={tmp_path / 'm'}", f"log={asked}", f"out={tmp_path / 'c'}")
    table = rows(tmp_path / "c" / "beliefs.csv")
    assert {row["cues"] for row in table} == {cue}
    right = np.array([row["label"] == row["truth"] for row in table])
    # Of 96 pictures a quarter has each form, and a quarter is right by chance. SIFT finds only
    # few points on stripes.
    assert right.reshape(24, 4).sum(axis=0).min() > 9
    assert right.sum() > 54
