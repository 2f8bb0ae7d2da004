"""A package installed by pip, plainly and editable, in an environment of its own."""

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "data" / "placecue-thirdparty"


@pytest.fixture(scope="module", params=["plain", "editable"])
def python(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment that sees placecue, with the package installed one way."""
    folder = tmp_path_factory.mktemp(request.param)
    source = folder / "package"
    shutil.copytree(PACKAGE, source)
    venv.create(folder / "env", with_pip=True)
    executable = folder / "env" / "bin" / "python"
    [site] = (folder / "env" / "lib").glob("python*/site-packages")
    here = sysconfig.get_paths()["purelib"]
    (site / "placecue_under_test.pth").write_text(f"import site; site.addsitedir({here!r})\n")
    how = ["--editable"] if request.param == "editable" else []
    install = [executable, "-m", "pip", "install", "--no-deps", "--no-build-isolation", "-q"]
    subprocess.run([*install, *how, source], check=True, capture_output=True, timeout=120)
    if request.param == "plain":
        shutil.rmtree(source)
    return executable


def placecue(python: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [python, "-m", "placecue", *words],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, **environment},
        check=False,
    )


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


def test_a_cue_without_an_option_file_still_has_an_option(python: Path) -> None:
    shown = placecue(python, "train", "cue=nearest", "cues.nearest.count=7", "--cfg", "job")
    assert shown.returncode == 0, shown.stderr
    assert "count: 7" in shown.stdout


def test_an_option_file_that_clashes_is_reported_and_left_out(python: Path) -> None:
    shown = placecue(python, "train", "cue=crfh", "--cfg", "job")
    assert "99" not in shown.stdout
    assert "cue/crfh.yaml of placecue-thirdparty" in shown.stderr


def test_no_plugins_runs_the_built_ins_alone(python: Path) -> None:
    listed = placecue(python, "--no-plugins", "plugins")
    assert "spread" not in listed.stdout
    assert "crfh" in listed.stdout
    refused = placecue(python, "train", "cue=spread", "--no-plugins")
    assert refused.returncode == 2
    assert "unknown cue 'spread'" in refused.stderr


def test_it_sees_the_same_placecue(python: Path) -> None:
    import placecue as ours

    code = "import placecue; print(placecue.__file__)"
    theirs = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True)
    assert theirs.stdout.strip() == ours.__file__
    assert Path(sys.executable) != python
