"""Law: what the page trains has the bits of the native training, and Python takes it along."""

import base64
import json
import shlex
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv.policies import load
from flockenv.training.branches import BranchTraining, training_flocks

pytestmark = pytest.mark.live

FLOCK = {"pool": "narrow", "n_boats": "10", "n_leaders": "4", "bw_s": "0.3"}
#: Three rounds of three pairs.
SHORT = {"flock_hours": 0.08, "pairs": 3}


@pytest.fixture(scope="module")
def trained(answer_of_node, wasm):
    def train(seed: int, **settings) -> dict[str, str]:
        question = {"wasm": str(wasm), "flock": FLOCK, "settings": {**SHORT, **settings}}
        return answer_of_node({**question, "seed": seed}, "tests/web/train_core.mjs")

    return train


def numbers(policy: str) -> dict[str, object]:
    """Return all of a policy's file but its provenance."""
    return {name: each for name, each in json.loads(policy).items() if name != "provenance"}


@pytest.mark.parametrize("seed", [0, 3])
def test_the_weights_are_those_of_the_native_training_and_of_the_command(
    trained, seed, cli, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    made = trained(seed)
    policy = numbers(made["policy"])
    assert max(map(abs, policy["weights"].values())) > 1e-3
    words = shlex.split(made["command"])
    assert words[:2] == ["flockenv", "train"]
    cli.succeeds(*words[1:], "--episodes", "2", "--out", "desk")
    assert numbers(Path("desk/policy.json").read_text("utf-8")) == policy
    settings = dict(word.split("=") for word in words if "=" in word)
    assert settings.pop("action_mode") == "rudder"
    options = {name: float(text) for name, text in settings.items() if name != "pairs"}
    flocks = training_flocks("narrow", n_boats=10, n_leaders=4, bw_s=0.3)
    native = BranchTraining(flocks, seed=seed, action_mode="rudder", **{**options, **SHORT})
    while not native.has_ended:
        native.advance()
    assert numbers(native.policy().to_json()) == policy


def test_another_seed_and_other_settings_have_other_weights(trained):
    weights = [numbers(each["policy"]) for each in (trained(0), trained(1), trained(0, step=0.1))]
    assert weights[0] != weights[1]
    assert weights[0] != weights[2]


def test_the_file_leads_flocks_in_python_as_on_the_page(trained, answer_of_node, wasm, tmp_path):
    text = trained(0, step=1.0)["policy"]
    file = tmp_path / "policy.json"
    file.write_text(text, "utf-8")
    assert float(load(file).provenance["flock_hours"]) == pytest.approx(0.08)
    fields = {"n_boats": 10, "n_leaders": 4, "bw_s": 0.3, "pool": "narrow", "target": "ccw"}
    native = flockenv.simulate(flockenv.FlockParameters(**fields), 7, 20.0, policy=file)
    assert np.abs(native.rudder).max() > 0.1
    request = {"parameters": fields, "seed": "7", "leaders": "trained", "trained": text}
    question = {"wasm": str(wasm), "runs": [{"request": request, "samples": 200}]}
    (end,) = answer_of_node(question, "tests/web/run_core.mjs")
    pose = np.frombuffer(base64.b64decode(end["pose"]), np.float64)
    assert np.array_equal(pose.reshape(-1, 3), native.pose[-1])


def test_compare_scores_the_file(trained, cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("policy.json").write_text(trained(0)["policy"], "utf-8")
    flocks = ["--pool", "narrow", "--n-boats", "10", "--n-leaders", "4", "--bw-s", "0.3"]
    short = ["--episodes", "2", "--minutes", "0.2", "--out", "compared"]
    named = ["--policy", "policy.json", "--name", "taken along"]
    said = cli.succeeds("compare", *named, *flocks, *short)
    assert "taken along" in said.stdout
