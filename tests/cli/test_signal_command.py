"""Law: the command prints and stores the signals that it measured."""

import csv
import json

import numpy as np

from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy


def test_signals_are_printed_and_stored(cli, tmp_path):
    command = ["signal", "--pool", "table-1", "--set", "n_boats=6", "--leaders", "1"]
    command += ["--reward", "rudder_effort", "--reward", "jam=1,signed_order=0.5", "--horizon", "1"]
    command += ["--from", "0.5", "--to", "0", "--flocks", "8", "--rounds", "1", "--minutes", "0.1"]
    done = cli(*command, "--json", "--out", str(tmp_path))
    rows = json.loads(done.stdout)
    assert [row["reward"] for row in rows] == ["rudder_effort", "jam=1,signed_order=0.5"]
    assert rows[0]["z"] > 3.0
    with (tmp_path / "signals.csv").open() as file:
        stored = list(csv.DictReader(file))
    assert [float(row["z"]) for row in stored] == [row["z"] for row in rows]
    assert 'seed = "0"' in (tmp_path / "run.toml").read_text()
    refused = cli(*command, "--reward", "jam=much")
    assert refused.returncode == 2
    assert "'much' is no weight" in refused.stderr


def test_directions_go_to_networks_of_any_layout(cli, tmp_path):
    blocks, size = {"order": False}, len(observation_entries({"order": False}))
    network = NetworkPolicy(
        [np.zeros((size, 1))],
        [np.zeros(1)],
        observation=blocks,
        mirror_to_target=True,
        action_mode="lean",
    )
    network.save(tmp_path / "network.npz")
    command = ["signal", "--pool", "table-1", "--set", "n_boats=6", "--leaders", "1"]
    command += ["--action-mode", "lean", "--from", "0.5", "--flocks", "8", "--rounds", "1"]
    command += ["--to", str(tmp_path / "network.npz"), "--minutes", "0.1", "--json"]
    action, weights = (
        json.loads(cli(*command, *more).stdout)[0]["z"] for more in ([], ["--weights", "--shared"])
    )
    assert np.isfinite([action, weights]).all()
    assert action != weights
    # The paper's law, where --from names nothing, observes what the network does.
    rudders = NetworkPolicy([np.zeros((size, 1))], [np.zeros(1)], observation=blocks)
    rudders.save(tmp_path / "rudders.npz")
    flock = ["--pool", "table-1", "--set", "n_boats=6", "--leaders", "1", "--minutes", "0.1"]
    flock += ["--flocks", "4", "--rounds", "1"]
    done = cli("signal", *flock, "--to", str(tmp_path / "rudders.npz"), "--json")
    assert np.isfinite(json.loads(done.stdout)[0]["z"])
    other = cli("signal", *flock, "--to", str(tmp_path / "rudders.npz"), "--from", "learned")
    assert other.returncode == 2
    assert "observe different layouts" in " ".join(other.stderr.split())
    refused = cli(*command[:-3], *command[-1:], "--weights", "--to", "1")
    assert refused.returncode == 2
    assert "to a NetworkPolicy" in " ".join(refused.stderr.split())
