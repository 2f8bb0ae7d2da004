import os
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse


@pytest.fixture(scope="session")
def reference() -> Path:
    """Reference data that does not live in the repository."""
    folder = os.environ.get("PLACECUE_REFERENCE")
    if not folder:
        pytest.skip("PLACECUE_REFERENCE is not set: it names the folder of reference data")
    return Path(folder)


@pytest.fixture(scope="session")
def reference_kernels(reference: Path) -> dict[str, np.ndarray]:
    """Kernels that the paper's group computed between four images' CRFH."""
    with np.load(reference / "crfh" / "kernels_t4_t64_meanrgb.npz") as known:
        return dict(known)


@pytest.fixture(scope="session")
def reference_histograms(
    reference: Path, reference_kernels: dict[str, np.ndarray]
) -> sparse.csr_array:
    """The CRFH of these images."""
    rows = []
    for name in reference_kernels["names"]:
        with np.load(reference / "crfh" / f"{name}.npz") as data:
            keys = data["t4_t64_meanrgb_key"]
            values = data["t4_t64_meanrgb_count"] / data["sum"]
        rows.append(sparse.csr_array((values, keys, [0, len(keys)]), shape=(1, 28**6)))
    return sparse.csr_array(sparse.vstack(rows, format="csr"))
