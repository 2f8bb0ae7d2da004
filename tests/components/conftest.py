"""Packages of third parties, installed by pip in environments of their own."""

import fcntl
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
    return environment(request.param, shared_folder(request, tmp_path_factory))


@pytest.fixture(scope="session")
def wheel(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The environment with the packages installed plainly."""
    return environment("plain", shared_folder(request, tmp_path_factory))


def shared_folder(request: pytest.FixtureRequest, factory: pytest.TempPathFactory) -> Path:
    """Return a folder of this run, the same for all its processes."""
    base = factory.getbasetemp()
    return base.parent if hasattr(request.config, "workerinput") else base


def environment(way: str, base: Path) -> Path:
    """Make an environment with the packages installed one way, once; return its Python."""
    folder = base / f"environment_{way}"
    executable = folder / "env" / "bin" / "python"
    with (base / f"{way}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "done").exists():
            install(way, folder, executable)
            (folder / "done").touch()
    return executable


def install(way: str, folder: Path, executable: Path) -> None:
    """Make the environment, in which placecue is seen and the packages are installed."""
    venv.create(folder / "env", with_pip=True)
    [site] = (folder / "env" / "lib").glob("python*/site-packages")
    here = sysconfig.get_paths()["purelib"]
    (site / "placecue_under_test.pth").write_text(f"import site; site.addsitedir({here!r})\n")
    sources = [shutil.copytree(DATA / name, folder / name) for name in PACKAGES]
    how = [["--editable", each] if way == "editable" else [each] for each in sources]
    pip = [executable, "-m", "pip", "install", "--no-deps", "--no-build-isolation", "-q"]
    words = [*pip, *(word for each in how for word in each)]
    subprocess.run(words, check=True, capture_output=True, timeout=300)
    if way == "plain":
        for each in sources:
            shutil.rmtree(each)
