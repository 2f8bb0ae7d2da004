"""A package installed by pip, plainly and editable, in an environment of its own."""

import subprocess
import sys
from pathlib import Path

from command_line import installed as placecue


def test_its_components_are_listed_with_distribution_and_version(python: Path) -> None:
    listed = placecue(python, "plugins")
    assert listed.returncode == 0, listed.stderr
    [row] = [line for line in listed.stdout.splitlines() if " spread " in line]
    assert row.split()[-3:] == ["placecue-thirdparty", "3.1", "ok"]


def test_its_config_group_is_found(python: Path) -> None:
    shown = placecue(python, "train", "cue=[spread,laser]", "--cfg", "job", "log=x")
    assert shown.returncode == 0, shown.stderr
    assert "power: 0.5" in shown.stdout
    assert "scaling: standard" in shown.stdout
    path = placecue(python, "train", "--info", "searchpath", "log=x")
    assert "pkg://thirdparty.conf" in path.stdout


def test_a_cue_without_an_option_file_still_has_an_option(wheel: Path) -> None:
    shown = placecue(wheel, "train", "cue=nearest", "cues.nearest.count=7", "--cfg", "job")
    assert shown.returncode == 0, shown.stderr
    assert "count: 7" in shown.stdout


def test_its_cues_may_be_parts_of_a_joint_one(wheel: Path) -> None:
    words = ["cues.joint.parts=[spread,laser,nearest]", "cues.joint.parts.nearest.count=7"]
    shown = placecue(wheel, "train", "cue=joint", "integrator=none", *words, "--cfg", "job")
    assert shown.returncode == 0, shown.stderr
    assert "      spread:\n        plugin: spread\n        power: 0.5\n      laser:" in shown.stdout
    assert "      nearest:\n        plugin: nearest\n        count: 7\n    plugin:" in shown.stdout


def test_an_option_file_that_clashes_is_reported_and_left_out(wheel: Path) -> None:
    shown = placecue(wheel, "train", "cue=crfh", "--cfg", "job")
    assert "99" not in shown.stdout
    assert "cue/crfh.yaml of placecue-thirdparty" in shown.stderr


def test_no_plugins_runs_the_built_ins_alone(wheel: Path) -> None:
    listed = placecue(wheel, "--no-plugins", "plugins")
    assert "spread" not in listed.stdout
    assert "crfh" in listed.stdout
    refused = placecue(wheel, "train", "cue=spread", "--no-plugins")
    assert refused.returncode == 2
    assert "unknown cue 'spread'" in refused.stderr


def test_it_sees_the_same_placecue(python: Path) -> None:
    import placecue as ours

    code = "import placecue; print(placecue.__file__)"
    theirs = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True)
    assert theirs.stdout.strip() == ours.__file__
    assert Path(sys.executable) != python
