"""Every engine gives the same bits, and each result as soon as it is finished."""

import os
import signal
import threading
from pathlib import Path

import pytest

import flockenv
from flockenv._io.interrupts import interrupted, noted_interrupts
from flockenv.runs.executors import ENGINES, Engine, cores, in_order, joblib, local, named
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RunStore, run_missing

PARAMETERS = flockenv.FlockParameters.preset("paper").replace(n_boats=8)
SPECS = [RunSpec(parameters=PARAMETERS, seed=seed, duration_s=20.0) for seed in range(4)]


def files(folder: Path, engine: Engine) -> dict[str, bytes]:
    assert run_missing(SPECS, RunStore(folder), engine, workers=2) == {}
    return {path.name: path.read_bytes() for path in folder.rglob("*.npz")}


def check_same_files(engine: Engine, folder: Path) -> None:
    expected = files(folder / "one", local)
    assert len(expected) == len(SPECS)
    assert files(folder / "other", engine) == expected


def test_joblib_writes_the_files_of_local(tmp_path: Path) -> None:
    check_same_files(joblib, tmp_path)


@pytest.mark.ray
def test_ray_writes_the_files_of_local(tmp_path: Path) -> None:
    import ray

    check_same_files(named("ray"), tmp_path)
    assert not ray.is_initialized()


@pytest.mark.ray
def test_a_connected_ray_is_used_and_left_running(tmp_path: Path) -> None:
    import ray

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        check_same_files(named("ray"), tmp_path)
        assert ray.is_initialized()
    finally:
        ray.shutdown()


def test_local_yields_what_is_finished_while_others_run() -> None:
    gate = threading.Event()

    def work(item: int) -> int:
        if item == 0:
            assert gate.wait(timeout=60)
        return 10 * item

    found = []
    for place, value in local(work, [0, 1, 2], workers=2):
        found.append((place, value))
        if len(found) == 2:
            gate.set()
    assert found == [(1, 10), (2, 20), (0, 0)]


def test_an_error_in_an_item_ends_the_work() -> None:
    with pytest.raises(ZeroDivisionError):
        list(local(lambda item: 1 // item, [1, 0, 1], workers=1))


def test_values_in_the_order_of_the_items_whatever_finishes_first() -> None:
    gate = threading.Event()

    def work(item: int) -> int:
        if item == 0:
            assert gate.wait(timeout=60)
        elif item == 2:
            gate.set()
        return 10 * item

    assert in_order(work, [0, 1, 2], workers=2) == [0, 10, 20]
    assert in_order(work, []) == []


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="affinity is Linux's")
def test_cores_are_those_that_the_process_may_use() -> None:
    allowed = os.sched_getaffinity(0)
    assert cores() == len(allowed)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        assert cores() == 1
    finally:
        os.sched_setaffinity(0, allowed)


def process(item: int) -> int:
    return os.getpid()


def test_joblib_runs_in_other_processes() -> None:
    places, pids = zip(*joblib(process, range(3), workers=2), strict=True)
    assert sorted(places) == [0, 1, 2]
    assert os.getpid() not in pids


def test_a_backend_of_joblib_by_name(tmp_path: Path) -> None:
    check_same_files(named("joblib:threading"), tmp_path)
    assert {pid for _, pid in named("joblib:threading")(process, range(2))} == {os.getpid()}


@pytest.mark.parametrize("backend", ["multiprocessing", "abacus"])
def test_backends_that_yield_all_at_the_end_are_refused(backend: str) -> None:
    with pytest.raises(flockenv.ParameterError, match=f"{backend}.*loky, threading or dask"):
        named(f"joblib:{backend}")


def test_an_unknown_engine_is_refused() -> None:
    with pytest.raises(flockenv.ParameterError, match="local, joblib, ray"):
        named("slurm")
    assert set(ENGINES) == {"local", "joblib", "ray"}


@pytest.mark.parametrize(
    "engine", ["local", "joblib:threading", "joblib", pytest.param("ray", marks=pytest.mark.ray)]
)
def test_a_noted_interrupt_lets_runs_under_way_end_and_starts_no_other(engine) -> None:
    items, found = range(100_000), []
    with noted_interrupts():
        for place, value in named(engine)(abs, items, workers=2):
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
