"""Law: what an earlier version wrote is read as it was written.

`tests/fixtures/<version>` holds files of every stored format, written by that version, and
`facts.json` what was in them (SHA-256 of arrays, numbers of policies). A format that moves gets a
further folder; the folders that are there never change.
"""

import hashlib
import json
import pickle
import shutil
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv import Flock, FlockParameters, Recording
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RunStore

FIXTURES = Path(__file__).parents[1] / "fixtures"
VERSIONS = sorted(path.name for path in FIXTURES.glob("v*"))
SMALL = {"n_boats": 6, "n_leaders": 2, "episode_s": 8.0}


@pytest.fixture(params=VERSIONS)
def folder(request):
    return FIXTURES / request.param


@pytest.fixture
def contents(folder):
    return json.loads((folder / "facts.json").read_text())


def sha(array):
    return hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()


def test_there_is_a_folder_of_an_earlier_version():
    assert "v0.1.0" in VERSIONS


def test_parameters(folder, contents):
    from_toml = FlockParameters.from_toml((folder / "parameters.toml").read_text())
    assert FlockParameters.from_dict(contents["parameters"]) == from_toml
    assert pickle.loads((folder / "parameters.pickle").read_bytes()) == from_toml


@pytest.mark.parametrize("name", ["recording", "recording_contacts"])
def test_recordings(folder, contents, name):
    recording, known = Recording.load(folder / f"{name}.npz"), contents[name]
    assert (len(recording), recording.seed) == (known["samples"], known["seed"])
    assert sha(recording.pose) == known["pose"]
    assert sha(recording.velocity) == known["velocity"]
    assert sha(recording.order.psi_o) == known["psi_o"]
    if "impulses" in known:
        assert sha(recording.contacts.force) == known["impulses"]


def test_recordings_without_a_policy_say_so(folder):
    recording = Recording.load(folder / "recording.npz")
    assert recording.policy is None
    assert recording.duration_s == recording.time_s[-1]


def test_recordings_in_format_2():
    recording = Recording.load(FIXTURES / "recording_format_2.npz")
    assert (len(recording), recording.duration_s, recording.policy) == (5, 6.0, "SteeringLaw()")
    assert sha(recording.pose)[:16] == "f5d9bac3e8bd3447"
    assert sha(recording.order.psi_o)[:16] == "b012db28434fb341"
    assert recording.rudder is None


def test_recordings_in_format_3():
    recording = Recording.load(FIXTURES / "recording_format_3.npz")
    assert (len(recording), recording.policy) == (
        5,
        "DampedLaw(gain=1.90986, backward_gain=1.90986, damping=3)",
    )
    assert sha(recording.pose)[:16] == "1edad91c4770bdbb"
    assert sha(recording.rudder)[:16] == "110ccdb33da0756c"


def test_snapshots(folder, contents):
    flock, known = (
        Flock.from_snapshot((folder / "flock.snapshot").read_bytes()),
        contents["snapshot"],
    )
    assert (flock.time_s, flock.phase) == (known["time_s"], known["phase"])
    assert sha(flock.pose) == known["pose"]
    assert sha(flock.velocity) == known["velocity"]
    flock.advance(1.0)
    assert np.isfinite(flock.pose).all()


def test_every_format_of_a_snapshot_is_read_as_the_same_state():
    # Format 2 has FNV-1a for a checksum, format 3 CRC-32.
    old, new = (FIXTURES / f"snapshot_format_{each}.snapshot" for each in (2, 3))
    assert old.read_bytes()[:8] == b"flockst2"
    flock = Flock.from_snapshot(old.read_bytes())
    assert (flock.time_s, len(flock.pose)) == (12.3, 6)
    assert flock.snapshot() == Flock.from_snapshot(new.read_bytes()).snapshot()
    assert new.read_bytes()[:8] == b"flockst3"
    assert flock.parameters == FlockParameters(n_boats=6, n_leaders=2)


@pytest.mark.parametrize("place", [20, 300])
def test_damage_shows_in_every_format_of_a_snapshot(place):
    for path in [*FIXTURES.glob("*.snapshot"), FIXTURES / "v0.1.0" / "flock.snapshot"]:
        content = bytearray(path.read_bytes())
        content[place] ^= 1
        with pytest.raises(flockenv.ParameterError, match="checksum differs"):
            Flock.from_snapshot(bytes(content))


def test_every_format_of_an_environments_state_goes_on_alike():
    env = gymnasium.make("flockenv/Leaders-v0", **SMALL).unwrapped
    rewards, summaries = [], []
    for each in (1, 2, 3):
        content = (FIXTURES / f"environment_format_{each}.state").read_bytes()
        assert content[:8] == b"flocken%d" % each
        env.reset(seed=2)
        env.set_state(content)
        over, own = False, []
        while not over:
            _, reward, _, over, info = env.step(np.array([0.1, 0.5], np.float32))
            own.append(reward)
        rewards.append(own)
        summaries.append(info["episode_summary"])
    assert rewards[0] == rewards[1] == rewards[2]
    assert len(rewards[0]) == 50
    # Format 1 held the sums of two of the quantities: the others have no mean over the episode.
    old, new, newer = summaries
    assert new == newer
    assert old == {name: new[name] for name in old}
    assert {"psi_o", "signed_order"} <= old.keys()
    assert new.keys() - old.keys() >= {"milling", "nematic"}


def test_states_of_an_environment(folder, contents):
    env, known = gymnasium.make("flockenv/Leaders-v0", **SMALL).unwrapped, contents["environment"]
    env.reset(seed=1)
    env.set_state((folder / "environment.state").read_bytes())
    assert sha(env.flock.pose) == known["pose"]
    assert known["episode"].items() <= env.episode().items()
    env.step(np.zeros(2, np.float32))


def test_states_of_a_vector_environment(folder, contents):
    env, known = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=2, **SMALL), contents["vector"]
    env.reset(seed=1)
    env.set_state((folder / "vector.state").read_bytes())
    assert sha(env.state()) == known["state"]
    env.step(np.zeros((2, 2), np.float32))


def test_keys_of_runs(contents):
    parameters = FlockParameters.from_dict(contents["parameters"])
    for protocol, key in contents["run_keys"].items():
        assert RunSpec(parameters=parameters, seed=3, duration_s=30.0, protocol=protocol).key == key


@pytest.mark.parametrize("keep", ["window", "order", "poses"])
def test_kept_runs_of_other_results_say_so_and_stay(folder, contents, keep, tmp_path):
    parameters, known = FlockParameters.from_dict(contents["parameters"]), contents["runs"][keep]
    spec = RunSpec(parameters=parameters, seed=3, duration_s=10.0, keep=keep)
    assert spec.key == known["key"]
    shutil.copytree(folder / "runs", tmp_path / "runs")
    lines = []
    # The numbers of 0.1.0 differ from today's by rounding: they are not mixed with new ones.
    assert RunStore(tmp_path / "runs", lines.append).load(spec) is None
    assert "is of another version" in lines[0]
    assert len(list((tmp_path / "runs" / "set_aside").iterdir())) == 1


@pytest.mark.parametrize("name", ["network", "leaning"])
def test_policies(folder, contents, name):
    policy = flockenv.policies.load(folder / f"{name}.npz")
    rudders, _ = policy.predict(np.load(folder / "rows.npy"))
    assert rudders.ravel() == pytest.approx(contents[name]["rudders"], abs=1e-5)


def test_checkpoints(folder):
    pytest.importorskip("stable_baselines3")
    from flockenv.training.checkpoint import read_settings

    settings = read_settings(folder / "checkpoint.npz")
    assert (settings.n_boats, settings.net_arch) == (6, (8,))
