"""Engines: where many independent runs are made. A spec goes to each of them unchanged.

All share one form, `Engine`: a function of (function, items, workers) that yields the place of each
item and the function's value of it, as they are finished and so in any order. Once Ctrl-C was noted
they start no further item, and end with those under way. What they are given must be pure and, but
for `local`, picklable: then results do not depend on the engine.
"""

import functools
import itertools
import os
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import Any, Protocol, TypeVar

from flockenv._io.extras import require
from flockenv._io.interrupts import end_if_interrupted, interrupted
from flockenv.errors import ParameterError

__all__ = ["ENGINES", "Engine", "cores", "in_order", "joblib", "local", "named", "ray"]

Item = TypeVar("Item")
Value = TypeVar("Value")


def cores() -> int:
    """Return how many cores this process may use, which a container or a queue may limit."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Engine(Protocol):
    """Anything that maps a function over items in parallel."""

    def __call__(
        self, function: Callable[[Item], Value], items: Sequence[Item], workers: int | None = None
    ) -> Generator[tuple[int, Value], None, None]:
        """Yield (place, function(items[place])) as they are finished."""


def _started(items: Sequence[Item]) -> Iterator[tuple[int, Item]]:
    """Yield items with their places, as long as no Ctrl-C was noted."""
    return itertools.takewhile(lambda _: not interrupted(), enumerate(items))


def local(
    function: Callable[[Item], Value], items: Sequence[Item], workers: int | None = None
) -> Generator[tuple[int, Value], None, None]:
    """Run in threads of this process: the simulator lets go of the interpreter while it runs.

    An error ends the work when the runs under way have ended.
    """
    at_once = workers or cores()
    waiting = _started(items)
    places: dict[Future[Value], int] = {}
    with ThreadPoolExecutor(at_once) as pool:
        while True:
            for place, item in itertools.islice(waiting, at_once - len(places)):
                places[pool.submit(function, item)] = place
            if not places:
                return
            for future in wait(places, return_when=FIRST_COMPLETED).done:
                yield places.pop(future), future.result()


def in_order(
    function: Callable[[Item], Value], items: Sequence[Item], workers: int | None = None
) -> list[Value]:
    """Return the values of a function in the order of the items, computed as by `local`."""
    values = dict(local(function, items, workers))
    end_if_interrupted()
    return [values[place] for place in range(len(items))]


def joblib(
    function: Callable[[Item], Value],
    items: Sequence[Item],
    workers: int | None = None,
    backend: str | None = None,
) -> Generator[tuple[int, Value], None, None]:
    """Run in joblib's worker processes, or on another backend of joblib.

    Parameters
    ----------
    function, items, workers
        As for every engine.
    backend
        "loky", "threading", "dask" or one that was registered; None for loky, or what
        `joblib.parallel_config` chose.

    Raises
    ------
    MissingExtraError
        Without the extra ``sweep``.
    ParameterError
        For an unknown backend, and for one that yields nothing before everything is finished, such
        as "multiprocessing": all would be lost with the first interruption.
    """
    task = require("joblib", "sweep").delayed(_numbered)
    parallel = _parallel(workers or -1, backend)
    yield from parallel(task(function, place, item) for place, item in _started(items))


def _parallel(workers: int, backend: str | None) -> Any:
    package = require("joblib", "sweep")
    try:
        return package.Parallel(workers, backend=backend, return_as="generator_unordered")
    except ImportError as error:
        raise ParameterError(f"joblib's backend {backend!r} cannot be used: {error}") from error
    except ValueError as error:
        raise ParameterError(
            f"joblib's backend {backend!r} is not accepted: one that yields each result as it is "
            "finished, such as loky, threading or dask"
        ) from error


def _numbered(
    function: Callable[[Item], Value], place: int, item: Item
) -> tuple[int, Value]:  # a module's function: worker processes find it by name
    return place, function(item)


def ray(
    function: Callable[[Item], Value], items: Sequence[Item], workers: int | None = None
) -> Generator[tuple[int, Value], None, None]:
    """Run as Ray tasks of one core each, two for each core of the cluster at a time.

    On the cluster that is connected already or that ``RAY_ADDRESS`` names; otherwise on a local
    Ray of `workers` cores, which is started and stopped here. Every node needs flockenv. What a
    node that dies was working on is done again on another one.

    Raises
    ------
    MissingExtraError
        Without the extra ``ray``.
    """
    package = require("ray", "ray")
    started = not package.is_initialized()
    if started:
        _start_ray(package, workers)
    tasks: dict[Any, int] = {}
    waiting = _started(items)
    try:
        # Repeated without end where a worker or its node is lost; an error of the function is not.
        remote = package.remote(num_cpus=1, max_retries=-1)(function)
        while True:
            # Counted again each time: nodes come and go.
            at_once = max(2, 2 * int(package.cluster_resources().get("CPU", 0)))
            for place, item in itertools.islice(waiting, max(0, at_once - len(tasks))):
                tasks[remote.remote(item)] = place
            if not tasks:
                return
            finished, _ = package.wait(list(tasks), num_returns=1)
            for task in finished:
                yield tasks.pop(task), package.get(task)
    finally:
        for task in tasks:
            package.cancel(task)
        if started:
            package.shutdown()


def _start_ray(package: Any, workers: int | None) -> None:
    options: dict[str, Any] = {"log_to_driver": False}
    if not os.environ.get("RAY_ADDRESS"):
        options |= {"num_cpus": workers or cores(), "include_dashboard": False}
    package.init(**options)


ENGINES: Mapping[str, Engine] = {"local": local, "joblib": joblib, "ray": ray}
"""Engines by name."""


def named(name: str) -> Engine:
    """Return an engine by its name, with a backend of joblib as in "joblib:threading".

    Raises
    ------
    ParameterError
        For an unknown name, where the message lists those there are, or as for `joblib`.
    MissingExtraError
        As for `joblib`.
    """
    engine, _, backend = name.partition(":")
    if engine == "joblib" and backend:
        _parallel(2, backend)
        return functools.partial(joblib, backend=backend)
    if name not in ENGINES:
        names = ", ".join([*ENGINES, "joblib:BACKEND"])
        raise ParameterError(f"engine = {name!r} is not accepted: {names}")
    return ENGINES[name]
