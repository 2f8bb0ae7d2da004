"""The executors that ``executor=`` chooses among."""

from __future__ import annotations

import logging
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from importlib.util import find_spec
from types import FrameType
from typing import Any

import joblib
from threadpoolctl import threadpool_limits

from placecue.errors import Interrupted, PlacecueError, UsageError, choices, told
from placecue.evaluation.executors.executor import Executor

Backend = Callable[[Mapping[str, Any]], AbstractContextManager[Executor]]


@contextmanager
def executor_of(config: Mapping[str, Any]) -> Iterator[Executor]:
    """Give the executor that a command's config chooses, and leave no worker behind.

    Parameters
    ----------
    config : mapping
        ``executor`` in it, with the keys of ``conf/placecue_conf/executor``, or its bare name;
        without it, tasks run one after the other.

    Raises
    ------
    UsageError
        If there is no such executor, or what it needs is not installed, or a number is wrong.
    PlacecueError
        If it cannot be started.
    Interrupted
        In the ``with`` block, when the process is told to end (SIGTERM).
    """
    given = config.get("executor") or "none"
    chosen: Mapping[str, Any] = {"name": given} if isinstance(given, str) else given
    name = chosen.get("name")
    if name not in BACKENDS:
        raise UsageError(f"unknown executor '{name}'; {choices(str(name), BACKENDS)}")
    with _ended_by_sigterm(), threadpool_limits(1), BACKENDS[name](chosen) as executor:
        yield executor


@contextmanager
def _none(chosen: Mapping[str, Any]) -> Iterator[Executor]:
    yield Executor("none", 1, {"backend": "sequential"})


@contextmanager
def _threads(chosen: Mapping[str, Any]) -> Iterator[Executor]:
    yield Executor("threads", _count(chosen, "jobs"), {"backend": "threading"})


@contextmanager
def _loky(chosen: Mapping[str, Any]) -> Iterator[Executor]:
    jobs = _count(chosen, "jobs")
    try:
        backend = {"backend": "loky", "inner_max_num_threads": 1}
        yield Executor("loky", jobs, backend)
    finally:
        joblib.externals.loky.get_reusable_executor().shutdown(wait=True, kill_workers=True)


@contextmanager
def _dask(chosen: Mapping[str, Any]) -> Iterator[Executor]:
    _check_installed("dask", "distributed")
    import dask
    import distributed

    from placecue.evaluation.executors.dask_executor import DaskExecutor

    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    address = chosen.get("address")
    if address is not None:
        with _connected(distributed.Client, str(address)) as client:
            yield DaskExecutor(client)
        return
    workers = _count(chosen, "workers")
    # Else dask tries a task whose worker died on three others before it gives up.
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(  # type: ignore[no-untyped-call]
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
            memory_limit=None,
            silence_logs=logging.CRITICAL,
        ) as cluster,
        _connected(distributed.Client, cluster) as client,
    ):
        yield DaskExecutor(client)


@contextmanager
def _connected(client: Any, where: Any) -> Iterator[Any]:
    try:
        connected = client(where, set_as_default=False)
    except (OSError, ValueError) as error:
        raise PlacecueError(
            f"executor.address={where} answers not ({told(error)}): give that of a dask scheduler, "
            "such as tcp://HOST:8786, or null for workers on this machine"
        ) from error
    with connected:
        if not connected.ncores():
            raise PlacecueError(f"the dask cluster {where} has no workers: start some")
        yield connected


@contextmanager
def _ray(chosen: Mapping[str, Any]) -> Iterator[Executor]:
    _check_installed("ray", "ray")
    import ray
    from ray.util.joblib import register_ray

    jobs = _count(chosen, "jobs")
    register_ray()
    started = not ray.is_initialized()
    if started:
        own = {"num_cpus": jobs, "include_dashboard": False, "_node_ip_address": "127.0.0.1"}
        ray.init(log_to_driver=False, **({"address": a} if (a := chosen.get("address")) else own))
    try:
        yield Executor("ray", jobs, {"backend": "ray"}, generates=False)
    finally:
        if started:
            ray.shutdown()


BACKENDS: dict[str, Backend] = {
    "loky": _loky,
    "threads": _threads,
    "dask": _dask,
    "ray": _ray,
    "none": _none,
}


def _check_installed(extra: str, package: str) -> None:
    if find_spec(package) is None:
        raise UsageError(
            f"executor={extra} needs {package}, which is not installed: "
            f"pip install 'placecue[{extra}]', or choose executor=loky"
        )


def _count(chosen: Mapping[str, Any], key: str) -> int:
    """Return a number of workers; that of the cores where none is given."""
    count = chosen.get(key)
    if count is None:
        cores: int = joblib.cpu_count()
        return cores
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise UsageError(
            f"executor.{key} cannot be {count!r}: give a number from 1, or null for one a core"
        )
    return count


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """Hear SIGTERM as one hears Ctrl-C, so that workers are ended as well."""
    if threading.current_thread() is not threading.main_thread():  # which alone may listen
        yield
        return

    def end(number: int, frame: FrameType | None) -> None:
        raise Interrupted("ended by SIGTERM")

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
