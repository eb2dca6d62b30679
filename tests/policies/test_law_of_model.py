"""Law: the leaning law of a trained model leans as the model does, from a file without torch.

On paper: an action is tanh(w·x + b), and stands for a lean of 1.2 rad at 1. The law's lean is
1.2·tanh((bias + Σ weight·x)/1.2), so that its weights are 1.2·w and its bias 1.2·b.
"""

import json

import numpy as np
import pytest

import flockenv
from flockenv import ParameterError
from flockenv.policies import LeaningLaw, ModelPolicy, load
from flockenv.policies.laws import LEAN_FEATURES

pytest.importorskip("stable_baselines3")

import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecNormalize

from flockenv.sb3 import LeaderVecEnv, SharedNoisePolicy, shared_noise

OFF = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
LEAN = {
    "pool": "wide",
    "n_boats": 6,
    "n_leaders": 2,
    "action_mode": "lean",
    "decision_period_s": 2.0,
    "episode_s": 16.0,
    "mirror_to_target": True,
    "observation": {**OFF, "lean_features": True},
}


def trained(squashed: bool = True, wrapper=lambda venv: venv, net_arch=None, **changes) -> PPO:
    venv = LeaderVecEnv(4, **{**LEAN, **changes})
    model = PPO(
        SharedNoisePolicy,
        wrapper(venv),
        n_steps=8,
        batch_size=32,
        learning_rate=0.05,
        use_sde=True,
        policy_kwargs={
            **shared_noise(venv, hold_s=4.0),
            "net_arch": {"pi": [], "vf": [8]} if net_arch is None else net_arch,
            "squash_output": squashed,
        },
        seed=1,
        device="cpu",
    )
    return model.learn(64)


@pytest.mark.parametrize("squashed", [True, False])
def test_it_leans_as_the_model(squashed, tmp_path):
    model = trained(squashed)
    with torch.no_grad():  # far enough to reach the bounds of a lean
        model.policy.action_net.weight *= 3.0
    LeaningLaw.from_model(model, "wide", provenance={"seed": "1"}).save(tmp_path / "law.json")
    law = load(tmp_path / "law.json")
    rows = np.random.default_rng(0).normal(0.0, 1.0, (64, len(LEAN_FEATURES))).astype(np.float32)
    actions = law.predict(rows)[0]
    np.testing.assert_allclose(actions, ModelPolicy(model).predict(rows)[0], atol=1e-6)
    assert np.ptp(actions) > 1.5
    assert law.bias == pytest.approx(1.2 * model.policy.action_net.bias.item())
    weight = model.policy.action_net.weight[0, 3].item()
    assert law.weights[LEAN_FEATURES[3]] == pytest.approx(1.2 * weight)
    assert (law.decision_period_s, law.provenance) == (2.0, {"seed": "1"})
    assert json.loads(law.to_json())["pool"] == "wide"


def test_it_leads_as_the_model():
    model, parameters = trained(), flockenv.FlockParameters(n_boats=6, n_leaders=2, pool="wide")
    runs = [
        flockenv.simulate(parameters, 3, 16.0, policy=policy).pose
        for policy in (LeaningLaw.from_model(model, "wide"), LeaningLaw("wide", 0.0, {}))
    ]
    env = flockenv.LeadersEnv(**LEAN, target="cw")
    seen, info = env.reset(seed=5)
    policy = ModelPolicy(model)
    for _ in range(8):
        seen, *_ = env.step(policy.predict(seen)[0])
    law = LeaningLaw.from_model(model, "wide")
    run = flockenv.simulate(env.flock.parameters, int(info["flock_seed"]), 16.0, policy=law)
    np.testing.assert_allclose(run.pose[-1], env.flock.pose, atol=1e-4)
    assert np.abs(runs[0] - runs[1]).max() > 0.1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"observation": {"lean_features": True, "neighbors": 1}}, "numbers observed"),
        ({"observation": {**LEAN["observation"], "own": True}}, "numbers observed"),
        ({"action_mode": "rudder"}, "actions of action_mode 'rudder'"),
        ({"mirror_to_target": False}, "mirror_to_target=False"),
        ({"control_hz": 5.0}, "5 control steps per second"),
        ({"net_arch": {"pi": [4], "vf": []}}, "an actor of more than one layer"),
        ({"wrapper": VecNormalize}, "VecNormalize around its environment"),
    ],
)
def test_other_models_are_named(change, words):
    with pytest.raises(ParameterError) as raised:
        LeaningLaw.from_model(trained(**change), "wide")
    assert words in str(raised.value)
    assert "linear in the 29 lean features" in str(raised.value)


def test_a_model_without_such_an_actor_is_named():
    model = SAC("MlpPolicy", LeaderVecEnv(1, **LEAN), buffer_size=8, device="cpu")
    with pytest.raises(ParameterError, match="an actor of more than one layer"):
        LeaningLaw.from_model(model, "wide")


@pytest.mark.parametrize("features", [29, 12])
def test_a_model_with_features_of_its_own_is_named(features):
    class Own(BaseFeaturesExtractor):
        def __init__(self, space):
            super().__init__(space, features)
            self.layers = torch.nn.Sequential(torch.nn.Linear(29, features), torch.nn.Tanh())

        def forward(self, rows):
            return self.layers(rows)

    options = {"net_arch": {"pi": [], "vf": [8]}, "features_extractor_class": Own}
    model = PPO("MlpPolicy", LeaderVecEnv(2, **LEAN), policy_kwargs=options, device="cpu")
    with pytest.raises(ParameterError, match="an actor of more than one layer"):
        LeaningLaw.from_model(model, "wide")


def test_weights_that_are_no_numbers_are_named():
    model = trained()
    with torch.no_grad():
        model.policy.action_net.weight[0, 0] = torch.nan
    with pytest.raises(ParameterError, match="not JSON compliant"):
        LeaningLaw.from_model(model, "wide")
