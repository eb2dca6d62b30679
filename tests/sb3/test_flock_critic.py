"""Law: the critic sees the whole flock, the actor what its leader observes, to the last step."""

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO

from flockenv import FlockParameters
from flockenv.comparison import run_episodes
from flockenv.errors import ParameterError
from flockenv.policies import load
from flockenv.sb3 import (
    FlockCriticPolicy,
    LeaderVecEnv,
    SharedNoisePolicy,
    WithFlockFeatures,
    evaluate_flocks,
    shared_noise,
)

OPTIONS = {"n_boats": 8, "n_leaders": 2, "episode_s": 0.3}


class Both(FlockCriticPolicy, SharedNoisePolicy):
    """Noise that is shared by a flock, and a critic that sees it."""


def model_of(venv, policy=FlockCriticPolicy, **options):
    return PPO(
        policy,
        venv,
        n_steps=8,
        batch_size=32,
        n_epochs=1,
        seed=0,
        device="cpu",
        policy_kwargs={**venv.policy_kwargs, "net_arch": [8], **options},
    )


def test_who_sees_what():
    venv = WithFlockFeatures(LeaderVecEnv(2, **OPTIONS))
    model = model_of(venv).learn(64)
    seen = venv.policy_kwargs["seen"]
    rows = venv.reset()
    other_flock, other_view = rows.copy(), rows.copy()
    other_flock[:, seen:] += 0.5
    other_view[:, :seen] += 0.5

    def values(rows):
        return model.policy.predict_values(model.policy.obs_to_tensor(rows)[0]).detach().numpy()

    actions = model.predict(rows, deterministic=True)[0]
    np.testing.assert_array_equal(actions, model.predict(other_flock, deterministic=True)[0])
    assert (actions != model.predict(other_view, deterministic=True)[0]).any()
    assert (values(rows) != values(other_flock)).all()


def test_rows_are_observations_and_features():
    venv, plain = (LeaderVecEnv(3, **OPTIONS) for _ in range(2))
    wrapped = WithFlockFeatures(venv)
    for each in (wrapped, plain):
        each.seed(5)
    rows, expected = wrapped.reset(), plain.reset()
    for step in range(3):
        features = plain.flock_features()
        np.testing.assert_array_equal(rows, np.concatenate([expected, features], axis=1))
        assert all(row in wrapped.observation_space for row in rows)
        actions = np.full((6, 1), 0.3 * step)
        rows, _, dones, infos = wrapped.step(actions)
        expected, *_ = plain.step(actions)
    assert dones.all()
    # The last rows stand in the infos; in their last number the episode is over.
    last = np.array([info["terminal_observation"] for info in infos])
    assert last.shape == rows.shape
    assert (last[:, -1] == 1.0).all()
    assert (rows[:, -1] == 0.0).all()
    seen = wrapped.policy_kwargs["seen"]
    np.testing.assert_array_equal(last[0, seen:], infos[1]["terminal_flock_features"])


def test_features_at_the_end_are_those_of_the_last_step():
    # With one longer episode the same step is in its middle: all but the part that is over agree.
    short, long = (LeaderVecEnv(1, **{**OPTIONS, "episode_s": s}) for s in (0.3, 0.6))
    for each in (short, long):
        each.seed(1)
        each.reset()
        for _ in range(3):
            *_, infos = each.step(np.zeros((2, 1)))
        if each is short:
            last = infos[0]["terminal_flock_features"]
    np.testing.assert_array_equal(last[:-1], long.flock_features()[0, :-1])


def test_it_goes_with_shared_noise_and_through_a_file(tmp_path):
    venv = WithFlockFeatures(LeaderVecEnv(4, **OPTIONS))
    model = model_of(venv, Both, **shared_noise(venv, 0.2)).learn(128)
    rows = torch.as_tensor(venv.reset())
    with torch.no_grad():
        actions, _, _ = model.policy.forward(rows)
        noise = (actions - model.policy.get_distribution(rows).distribution.mean)[:, 0]
    assert torch.allclose(noise[::2], noise[1::2], atol=1e-6)
    assert len(torch.unique(noise[::2])) == 4
    model.save(tmp_path / "model.zip")
    read = PPO.load(tmp_path / "model.zip", device="cpu")
    expected = model.predict(rows.numpy(), deterministic=True)[0]
    np.testing.assert_array_equal(read.predict(rows.numpy(), deterministic=True)[0], expected)


def test_the_model_steers_wherever_a_policy_does(tmp_path):
    options = {**OPTIONS, "pool": "narrow", "action_mode": "lean", "decision_period_s": 0.2}
    options["episode_s"] = 2.0
    venv = WithFlockFeatures(LeaderVecEnv(2, **options))
    model = model_of(venv).learn(64)
    rows = venv.reset()
    seen = venv.policy_kwargs["seen"]
    whole, part = (model.predict(each, deterministic=True)[0] for each in (rows, rows[:, :seen]))
    np.testing.assert_array_equal(whole, part)
    model.save(tmp_path / "model.zip")
    policy = load(tmp_path / "model.zip", trust=True)
    assert (policy.action_mode, policy.decision_period_s, policy.leaders) == ("lean", 0.2, 1)
    np.testing.assert_array_equal(policy.predict(rows[:, :seen])[0], np.clip(whole, -1.0, 1.0))
    parameters = FlockParameters(n_boats=8, n_leaders=3, pool="narrow")
    found = run_episodes(parameters, model, [0], 10.0)
    assert np.isfinite(found["signed_order"]).all()
    evaluated = evaluate_flocks(model, venv, n_eval_episodes=2, seed=0)
    assert np.isfinite(evaluated.returns).all()
    with pytest.raises(ParameterError, match=r"'lean'.*'rudder'"):
        evaluate_flocks(model, WithFlockFeatures(LeaderVecEnv(2, **OPTIONS)))


def test_bad_input_is_refused():
    with pytest.raises(TypeError, match="a LeaderVecEnv is needed"):
        WithFlockFeatures(WithFlockFeatures(LeaderVecEnv(2, **OPTIONS)))
    venv = WithFlockFeatures(LeaderVecEnv(2, **OPTIONS))
    for seen in (0, 10_000):
        with pytest.raises(ParameterError, match=f"seen = {seen}"):
            model_of(venv, seen=seen)
