"""What every test can rely on."""

import gc
import logging
import sys
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

# All tests stay in memory: looking through them for garbage took a tenth of the time.
gc.set_threshold(50_000, 50, 50)

# A busy machine is no failure, and every run asks the same.
settings.register_profile(
    "placecue", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("placecue")


@pytest.fixture(autouse=True)
def same_log_levels() -> Iterator[None]:
    """Put back the levels that a command run in this process has changed (hydra.verbose)."""
    names = [None, "placecue"]
    levels = [logging.getLogger(name).level for name in names]
    yield
    for name, level in zip(names, levels, strict=True):
        logging.getLogger(name).setLevel(level)


@pytest.fixture(scope="session", autouse=True)
def cache_of_tests(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep the features that tests extract away from the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PLACECUE_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session", autouse=True)
def kept_bytecode(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Let commands that tests start keep their bytecode, or each compiles all that it imports."""
    with pytest.MonkeyPatch.context() as patch:
        if sys.dont_write_bytecode:
            patch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)
            patch.setenv("PYTHONPYCACHEPREFIX", str(tmp_path_factory.mktemp("bytecode")))
        yield


@pytest.fixture(autouse=True)
def own_cache(
    cache_of_tests: None, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Let no test find what another has extracted."""
    monkeypatch.setenv("PLACECUE_CACHE", str(tmp_path_factory.mktemp("cache")))
