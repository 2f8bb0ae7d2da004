"""Deep cues on the command line: what is wrong is said in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from command_line import placecue
from placecue import Observation
from rooms import Rooms, write_log

ALONE = "integrator=none"


@pytest.fixture(scope="module")
def blind(shared: Path) -> Path:
    """A log without a camera."""
    seen = [
        Observation(each.stamp, scan=each.scan, pose=each.pose, label=each.label)
        for each in Rooms()
    ]
    return write_log(shared / "blind.mcap", seen)


@pytest.mark.parametrize(
    ("words", "status", "reason"),
    [
        (["cue=onnx"], 2, "give an ONNX file, cues.onnx.model=FILE"),
        (["cue=onnx", "cues.onnx.model=gone.onnx"], 2, "gone.onnx cannot be read: No such file"),
        (["cue=lite0", "cues.lite0.network=lite9"], 2, "network is 'lite9'"),
        (["cue=lite0", "cues.lite0.output=logit"], 2, "did you mean 'logits'?"),
        (["cue=lite0", "cues.lite0.threads=none"], 2, "threads must be a whole number"),
        (["cue=objects", "cues.objects.classifier.more=gone.yaml"], 1, "gone.yaml"),
        (["cue=objects", "cues.objects.network=lite0"], 2, "output=logits"),
        (
            ["cue=objects", "cues.objects.classifier.places=office"],
            2,
            "places must be a list of texts",
        ),
        (["cue=objects"], 2, "the table has no place 'lab'"),
    ],
)
def test_what_is_wrong(log_a: Path, words: list[str], status: int, reason: str) -> None:
    told = placecue("train", *words, ALONE, f"log={log_a}", "out=m")
    assert reason in told.line
    assert told.status == status
    assert not Path("m", "manifest.json").exists()


@pytest.mark.parametrize("cue", ["lite0", "objects"])
def test_a_log_without_a_camera(blind: Path, cue: str) -> None:
    told = placecue("train", f"cue={cue}", ALONE, f"log={blind}", "out=m")
    assert told.status in (1, 2)
    assert "image" in told.line
