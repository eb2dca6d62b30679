"""Ray: a node that dies amid a sweep costs time and nothing else; few tasks are in flight."""

import time
from pathlib import Path

import pytest

from flockenv.runs.executors import finished, named
from flockenv.runs.sweep import read_sweep, run_sweep

pytestmark = pytest.mark.ray

SPEC = "minutes = 10\nseeds = 6\n[[grid]]\nn_boats = [20]\nbw_s = [0.0, 0.4]\n"


@pytest.fixture
def two_nodes():
    import ray
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    node = cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    try:
        yield cluster, node
    finally:
        ray.shutdown()
        cluster.shutdown()


def test_a_sweep_outlives_a_node(two_nodes, tmp_path: Path) -> None:
    cluster, node = two_nodes
    (tmp_path / "spec.toml").write_text(SPEC)
    sweep = read_sweep(tmp_path / "spec.toml")
    made = []

    def kill_a_node(spec) -> None:
        made.append(spec)
        if len(made) == 3:
            cluster.remove_node(node, allow_graceful=False)

    run_sweep(sweep, tmp_path / "ray", named("ray"), kill_a_node)
    assert len(made) == len(sweep.runs)
    run_sweep(sweep, tmp_path / "local")
    for name in ("sweep.csv", "sweep.parquet"):
        assert (tmp_path / "ray" / name).read_bytes() == (tmp_path / "local" / name).read_bytes()


def started(item: tuple[str, int]) -> int:
    folder, number = item
    Path(folder, str(number)).touch()
    return number


def test_few_items_are_in_flight(two_nodes, tmp_path: Path) -> None:
    items = [(str(tmp_path), number) for number in range(40)]
    results = finished(started, items, engine=named("ray"))
    found = [next(results)]
    time.sleep(2.0)
    # Two for each of two cores, although nothing else keeps the cluster busy.
    assert len(list(tmp_path.iterdir())) <= 4
    found += results
    assert sorted(found) == [(number, number) for number in range(40)]
