"""Packages of third parties, installed by pip in environments of their own."""

import shutil
import subprocess
import sysconfig
import venv
from functools import cache
from pathlib import Path

import pytest

DATA = Path(__file__).parents[1] / "data"
PACKAGES = ("placecue-thirdparty", "placecue-everykind")


@pytest.fixture(scope="session", params=["plain", "editable"])
def python(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment that sees placecue, with the packages installed one way."""
    return environment(request.param, tmp_path_factory.getbasetemp())


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The environment with the packages installed plainly."""
    return environment("plain", tmp_path_factory.getbasetemp())


@cache
def environment(way: str, base: Path) -> Path:
    """Make an environment with the packages installed one way; return its Python."""
    folder = base / f"environment_{way}"
    venv.create(folder / "env", with_pip=True)
    executable = folder / "env" / "bin" / "python"
    [site] = (folder / "env" / "lib").glob("python*/site-packages")
    here = sysconfig.get_paths()["purelib"]
    (site / "placecue_under_test.pth").write_text(f"import site; site.addsitedir({here!r})\n")
    sources = [shutil.copytree(DATA / name, folder / name) for name in PACKAGES]
    how = [["--editable", each] if way == "editable" else [each] for each in sources]
    install = [executable, "-m", "pip", "install", "--no-deps", "--no-build-isolation", "-q"]
    words = [*install, *(word for each in how for word in each)]
    subprocess.run(words, check=True, capture_output=True, timeout=300)
    if way == "plain":
        for each in sources:
            shutil.rmtree(each)
    return executable
