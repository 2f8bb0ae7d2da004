"""Outer folds of recorded frames part no scene."""

import os
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
DATA = os.environ.get("PLACECUE_DATA")
needs_data = pytest.mark.skipif(DATA is None, reason="PLACECUE_DATA is not set")


@pytest.fixture
def nyu(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return import_module("nyu_frames")


@needs_data
@pytest.mark.parametrize(("rooms", "frames"), [("four", 330), ("eight", 470)])
def test_every_frame_is_held_out_once_and_no_scene_is_parted(nyu, rooms, frames):
    folds = list(nyu.outer_folds(Path(str(DATA)), nyu.ROOMS[rooms], parts=["label"]))
    assert len(folds) == 5
    stamps = [each.stamp for fold in folds for each in fold.held_out]
    assert len(stamps) == len(set(stamps)) == frames
    for training, held_out in folds:
        assert len(training) + len(held_out) == frames
        assert set(training.labels) == set(held_out.labels) == set(nyu.ROOMS[rooms])
        assert not set(training.scenes) & set(held_out.scenes)
        # Balanced: a fifth of each class, within a scene and a half (of 7 frames at most).
        for name in nyu.ROOMS[rooms]:
            share = (held_out.labels == name).sum() - frames_of(folds, name) / 5
            assert abs(share) < 3


def frames_of(folds, name):
    return sum(np.count_nonzero(fold.held_out.labels == name) for fold in folds)
