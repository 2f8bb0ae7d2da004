"""What every test can rely on."""

import logging
from collections.abc import Iterator

import pytest


@pytest.fixture(autouse=True)
def same_log_levels() -> Iterator[None]:
    """Put back the levels that a command run in this process has changed (hydra.verbose)."""
    names = [None, "placecue"]
    levels = [logging.getLogger(name).level for name in names]
    yield
    for name, level in zip(names, levels, strict=True):
        logging.getLogger(name).setLevel(level)
