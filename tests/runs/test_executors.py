"""Every executor gives the same bits, and each result as soon as it is finished."""

import os
import signal
import threading
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

import flockenv
from flockenv._io.interrupts import interrupted, noted_interrupts
from flockenv.runs.executors import Engine, cores, finished, in_order, named, threads
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RunStore, run_missing

PARAMETERS = flockenv.FlockParameters.preset("paper").replace(n_boats=8)
SPECS = [RunSpec(parameters=PARAMETERS, seed=seed, duration_s=20.0) for seed in range(4)]


def processes(workers: int | None) -> ProcessPoolExecutor:
    """An executor of Python's own: any other serves as well."""
    return ProcessPoolExecutor(workers, get_context("spawn"))


def files(folder: Path, engine: Engine) -> dict[str, bytes]:
    assert run_missing(SPECS, RunStore(folder), engine, workers=2) == {}
    return {path.name: path.read_bytes() for path in folder.rglob("*.npz")}


def check_same_files(engine: Engine, folder: Path) -> None:
    expected = files(folder / "one", threads)
    assert len(expected) == len(SPECS)
    assert files(folder / "other", engine) == expected


def test_other_processes_write_the_files_of_threads(tmp_path: Path) -> None:
    check_same_files(processes, tmp_path)


@pytest.mark.ray
def test_ray_writes_the_files_of_threads(tmp_path: Path) -> None:
    import ray

    check_same_files(named("ray"), tmp_path)
    assert not ray.is_initialized()
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        check_same_files(named("ray"), tmp_path / "connected")
        assert ray.is_initialized()
    finally:
        ray.shutdown()


def test_what_is_finished_comes_while_others_run() -> None:
    gate = threading.Event()

    def work(item: int) -> int:
        if item == 0:
            assert gate.wait(timeout=60)
        return 10 * item

    found = []
    for place, value in finished(work, [0, 1, 2], workers=2):
        found.append((place, value))
        if len(found) == 2:
            gate.set()
    assert found == [(1, 10), (2, 20), (0, 0)]
    assert in_order(work, [0, 1, 2], workers=2) == [0, 10, 20]
    assert in_order(work, []) == []


def test_an_error_in_an_item_ends_the_work() -> None:
    with pytest.raises(ZeroDivisionError):
        list(finished(lambda item: 1 // item, [1, 0, 1], workers=1))


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="affinity is Linux's")
def test_cores_are_those_that_the_process_may_use() -> None:
    allowed = os.sched_getaffinity(0)
    assert cores() == len(allowed)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        assert cores() == 1
    finally:
        os.sched_setaffinity(0, allowed)


def same(item: int) -> int:  # Ray takes no builtin function.
    return item


@pytest.mark.parametrize("engine", [threads, pytest.param("ray", marks=pytest.mark.ray)])
def test_a_noted_interrupt_lets_runs_under_way_end_and_starts_no_other(engine) -> None:
    engine = engine if callable(engine) else named(engine)
    items, found = range(100_000), []
    with noted_interrupts():
        for place, value in finished(same, items, 2, engine):
            found.append((place, value))
            if not interrupted():
                signal.raise_signal(signal.SIGINT)
    assert 0 < len(found) < len(items)
    assert all(place == value for place, value in found)


def test_values_in_order_are_all_or_none() -> None:
    def work(item: int) -> None:
        if item == 1:
            signal.raise_signal(signal.SIGINT)

    with noted_interrupts(), pytest.raises(KeyboardInterrupt):
        in_order(work, range(1000), workers=2)
