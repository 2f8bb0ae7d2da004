"""Tasks that worker processes can import."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path

import numpy as np

from placecue.errors import DataError


def spectrum(seed: int) -> bytes:
    """Eigenvalues that come out otherwise, in the last bits, where BLAS has other threads."""
    a = np.random.default_rng(seed).normal(size=(300, 300))
    return np.linalg.eigvalsh(a @ a.T).tobytes()


def may_fail(task: str) -> str:
    if task == "no log":
        raise DataError("no such log: a.mcap")
    if task == "foreign":
        raise ValueError("two\nlines")
    if task == "leave":
        raise SystemExit(3)
    if task == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if task == "unpicklable":
        return threading.Lock()  # type: ignore[return-value]
    return task.upper()


def threads(_: int) -> list[int]:
    from threadpoolctl import threadpool_info

    np.linalg.eigvalsh(np.eye(3))
    return [each["num_threads"] for each in threadpool_info()]


def sleep_long(folder: str) -> None:
    (Path(folder) / str(os.getpid())).touch()
    time.sleep(600)
