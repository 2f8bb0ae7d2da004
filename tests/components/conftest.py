"""Packages of third parties, installed by pip in environments of their own."""

import shutil
import subprocess
import sysconfig
import venv
from pathlib import Path

import pytest

DATA = Path(__file__).parents[1] / "data"
PACKAGES = ("placecue-thirdparty", "placecue-everykind")


@pytest.fixture(scope="session", params=["plain", "editable"])
def python(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment that sees placecue, with the packages installed one way."""
    folder = tmp_path_factory.mktemp(request.param)
    venv.create(folder / "env", with_pip=True)
    executable = folder / "env" / "bin" / "python"
    [site] = (folder / "env" / "lib").glob("python*/site-packages")
    here = sysconfig.get_paths()["purelib"]
    (site / "placecue_under_test.pth").write_text(f"import site; site.addsitedir({here!r})\n")
    sources = [shutil.copytree(DATA / name, folder / name) for name in PACKAGES]
    how = [["--editable", each] if request.param == "editable" else [each] for each in sources]
    install = [executable, "-m", "pip", "install", "--no-deps", "--no-build-isolation", "-q"]
    words = [*install, *(word for each in how for word in each)]
    subprocess.run(words, check=True, capture_output=True, timeout=120)
    if request.param == "plain":
        for each in sources:
            shutil.rmtree(each)
    return executable
