import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def reference() -> Path:
    """Reference data that does not live in the repository."""
    folder = os.environ.get("PLACECUE_REFERENCE")
    if not folder:
        pytest.skip("PLACECUE_REFERENCE is not set: it names the folder of reference data")
    return Path(folder)
