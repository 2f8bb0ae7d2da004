"""What is compared in docs/deep.md."""

from __future__ import annotations

from nyu_frames import ROOMS

#: Cues, with the words that set them.
CUES: dict[str, list[str]] = {
    "lite0": [],
    "laser": ["cues.laser.preset=full"],
    "crfh": [],
}
#: Cues by the name of the row, and how they are integrated.
METHODS: dict[str, tuple[tuple[str, ...], str]] = {
    "lite0": (("lite0",), ""),
    "laser": (("laser",), ""),
    "CRFH": (("crfh",), ""),
    "CRFH + laser": (("crfh", "laser"), "svm_das"),
    "lite0 + laser": (("lite0", "laser"), "svm_das"),
    "lite0 + laser, linear": (("lite0", "laser"), "svm_das_linear"),
    "lite0 + laser, G-DAS": (("lite0", "laser"), "gdas"),
}
#: The networks, smallest first.
NETWORKS = ("lite0", "lite1", "lite2")
#: Frames that are timed one by one.
TIMED = 100
#: What the light is divided by in test.
DARKER = (2, 4, 8)
#: The rows of the figure.
SHOWN_DARK = ("lite0", "laser", "CRFH", "CRFH + laser", "lite0 + laser")
#: Labels a class; 0 is all of the training frames.
FEW = (1, 5, 10, 0)
#: Which places the table is asked for.
PLACES = {
    "four": ROOMS["four"],
    "six": (*ROOMS["four"], "dining_room", "office"),
    "eight": ROOMS["eight"],
}
FOLDS = 5
