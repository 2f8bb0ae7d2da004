"""Runs joblib's tasks on a dask cluster.

joblib's own backend for dask waits for ever for a task whose worker died.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from joblib.parallel import ParallelBackendBase

#: How long the answer of a finished task may travel, s.
PATIENCE = 60


class DaskBackend(ParallelBackendBase):  # type: ignore[misc]
    """A backend of joblib.

    Parameters
    ----------
    client : distributed.Client
        Of the cluster.
    nesting_level, inner_max_num_threads
        As joblib has them.
    """

    supports_retrieve_callback = True

    def __init__(
        self,
        client: Any,
        nesting_level: int | None = None,
        inner_max_num_threads: int | None = None,
    ) -> None:
        super().__init__(nesting_level, inner_max_num_threads)
        self._client = client
        self._open: set[Any] = set()

    def effective_n_jobs(self, n_jobs: int) -> int:
        """Return the number of threads of all workers; joblib would run a single one here."""
        threads: int = sum(self._client.ncores().values())
        return max(2, threads)

    def configure(self, n_jobs: int = 1, parallel: Any = None, **_: Any) -> int:
        """Get ready for one call of joblib."""
        self.parallel = parallel
        return self.effective_n_jobs(n_jobs)

    def submit(self, func: Callable[[], Any], callback: Callable[[Any], None] | None = None) -> Any:
        """Send a task, and have ``callback`` called with its future, however it ends."""
        future = self._client.submit(func, pure=False)
        self._open.add(future)
        future.add_done_callback(partial(self._done, callback))
        return future

    apply_async = submit  # its name before joblib 1.5

    def _done(self, callback: Callable[[Any], None] | None, future: Any) -> None:
        self._open.discard(future)
        if callback is not None:
            callback(future)

    def retrieve_result_callback(self, out: Any) -> Any:
        """Return what a task returned, or raise why there is nothing.

        One whose answer was lost with its worker, or that was taken back, would be waited for.
        """
        if out.status not in ("finished", "error"):
            raise RuntimeError(f"dask lost its answer ({out.status})")
        return out.result(timeout=PATIENCE)

    def abort_everything(self, ensure_ready: bool = True) -> None:
        """Take back what has not begun."""
        self._client.cancel(list(self._open))
        self._open.clear()
