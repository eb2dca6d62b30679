"""BenchMARL's learners: each saves a policy that every command takes, and says what made it."""

import pytest

from flockenv import FlockParameters
from flockenv.comparison import run_episodes
from flockenv.policies import NetworkPolicy

pytestmark = [pytest.mark.benchmarl, pytest.mark.filterwarnings("ignore")]

pytest.importorskip("benchmarl")


@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", ["ippo", "mappo"])
def test_a_training_saves_a_policy(script, name, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(script, "FLOCKS", 4)
    monkeypatch.setattr(script, "DECISIONS", 8)
    monkeypatch.setitem(script.TASK, "episode_s", 8.0)
    script.main(name, 3, 64 / 3600, tmp_path)
    policy = NetworkPolicy.load(tmp_path / "policy.npz")
    assert policy.provenance["flock_hours"] == f"{64 / 3600:.6g}"
    assert policy.provenance["samples"] == "192"
    flock = FlockParameters(pool="wide", n_boats=9, n_leaders=3, bw_s=script.TASK["bw_s"])
    assert abs(run_episodes(flock, policy, [0], 5.0)["signed_order"][0]) <= 1
