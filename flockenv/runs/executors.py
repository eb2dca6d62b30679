"""Executors: threads, processes or machines that make many independent runs.

All have the interface of `concurrent.futures.Executor`, like those of other libraries. The
functions that they call must be pure, so that results do not depend on the executor. Except for
threads they must be picklable, too.
"""

import functools
import itertools
import os
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from types import ModuleType
from typing import Any, TypeVar

from flockenv._io.extras import require
from flockenv._io.interrupts import end_if_interrupted, interrupted
from flockenv.errors import refuse_unknown

Item = TypeVar("Item")
Value = TypeVar("Value")

Engine = Callable[[int | None], Executor]
"""Function that makes an executor, given its number of workers; None means one for each core."""


def cores() -> int:
    """Return the number of cores that this process may use, which a queue may limit."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def threads(workers: int | None = None) -> Executor:
    """Return an executor of threads, which run in parallel.

    The simulator releases the interpreter lock while it runs.
    """
    return ThreadPoolExecutor(workers or cores())


class RayExecutor(Executor):
    """Ray tasks of one core each, on any cluster whose nodes all have flockenv.

    The cluster is the one connected already, or the one that ``RAY_ADDRESS`` names. Otherwise a
    local Ray is started, and `shutdown` stops it. If a node dies, other nodes repeat its tasks.

    Parameters
    ----------
    workers
        Cores of a local Ray; None for all.

    Raises
    ------
    MissingExtraError
        Without the extra ``ray``.
    """

    def __init__(self, workers: int | None = None) -> None:
        self._ray: ModuleType = require("ray", "ray")
        self._started_ray = not self._ray.is_initialized()
        if self._started_ray:
            options: dict[str, Any] = {"log_to_driver": False}
            if not os.environ.get("RAY_ADDRESS"):
                options |= {"num_cpus": workers or cores(), "include_dashboard": False}
            self._ray.init(**options)
        # Each function is sent to the cluster only once.
        self._remote = functools.cache(self._ray.remote(num_cpus=1, max_retries=-1))

    @property
    def at_once(self) -> int:
        """Number of tasks to keep in flight: two for each core that the cluster has now."""
        return max(2, 2 * int(self._ray.cluster_resources().get("CPU", 0)))

    def submit(
        self, function: Callable[..., Value], /, *arguments: object, **keywords: object
    ) -> "Future[Value]":
        """Start a task, which is repeated whenever its node is lost."""
        future: Future[Value] = self._remote(function).remote(*arguments, **keywords).future()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Stop Ray if it was started here; its unfinished tasks end with it."""
        if self._started_ray:
            self._ray.shutdown()


ENGINES: Mapping[str, Engine] = {"local": threads, "ray": RayExecutor}
"""Engines by name."""


def named(name: str) -> Engine:
    """Return an engine by its name; the error for an unknown name lists all names."""
    refuse_unknown((name,), ENGINES, "engine")
    return ENGINES[name]


def finished(
    function: Callable[[Item], Value],
    items: Sequence[Item],
    workers: int | None = None,
    engine: Engine = threads,
) -> Generator[tuple[int, Value], None, None]:
    """Yield each item's index and the function's value for it, in the order in which they finish.

    After Ctrl-C no further item is started, and those in progress are finished. An error of the
    function is raised, and ends the work in the same manner.
    """
    waiting = itertools.takewhile(lambda _: not interrupted(), enumerate(items))
    indices: dict[Future[Value], int] = {}
    with engine(workers) as executor:
        while True:
            at_once = getattr(executor, "at_once", None) or workers or cores()
            for index, item in itertools.islice(waiting, max(0, at_once - len(indices))):
                indices[executor.submit(function, item)] = index
            if not indices:
                return
            for future in wait(indices, return_when=FIRST_COMPLETED).done:
                yield indices.pop(future), future.result()


def in_order(
    function: Callable[[Item], Value], items: Sequence[Item], workers: int | None = None
) -> list[Value]:
    """Return the values of a function in the order of the items, computed in threads."""
    values = dict(finished(function, items, workers))
    end_if_interrupted()
    return [values[index] for index in range(len(items))]
