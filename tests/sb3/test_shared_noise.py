"""Law: the noise of a flock's leaders is one number, other flocks' are independent of it, and it is
held for exactly the time that was given."""

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO

import flockenv
from flockenv.comparison import run_episodes
from flockenv.errors import ParameterError
from flockenv.sb3 import LeaderVecEnv, SharedNoisePolicy, evaluate_flocks, shared_noise

OPTIONS = {"n_boats": 6, "pool": "narrow", "action_mode": "lean", "decision_period_s": 0.5}


def model_of(venv, hold_s=2.0, use_sde=False, **options):
    return PPO(
        SharedNoisePolicy,
        venv,
        n_steps=8,
        batch_size=venv.num_envs * 8,
        n_epochs=1,
        seed=3,
        device="cpu",
        use_sde=use_sde,
        policy_kwargs={**shared_noise(venv, hold_s), **options},
    )


def noise_of(policy, rows):
    with torch.no_grad():
        actions, _, log_prob = policy.forward(torch.as_tensor(rows))
        distribution = policy.get_distribution(torch.as_tensor(rows)).distribution
        expected = distribution.log_prob(actions).sum(dim=1)
    assert torch.allclose(log_prob, expected)
    return ((actions - distribution.mean) / distribution.stddev).numpy()[:, 0]


def test_noise_is_shared_by_a_flock_and_held():
    venv = LeaderVecEnv(40, n_leaders=[1, 2, 3], **OPTIONS)
    venv.seed(0)
    rows = venv.reset()
    policy = model_of(venv, net_arch=[2]).policy
    noises = np.array([noise_of(policy, rows) for _ in range(400)])
    flock = venv.flock_of_slot
    first = np.searchsorted(flock, np.arange(40))
    np.testing.assert_allclose(noises, noises[:, first][:, flock], atol=1e-5)
    # 2 s are four decisions of 0.5 s: equal in blocks of four, and new in each block.
    blocks = noises[:, first].reshape(100, 4, 40)
    np.testing.assert_allclose(blocks, np.repeat(blocks[:, :1], 4, axis=1), atol=1e-5)
    own = blocks[:, 0]
    assert np.abs(np.diff(own, axis=0)).min(axis=0).max() > 1e-3
    correlation = np.corrcoef(own.T) - np.eye(40)
    assert np.abs(correlation).max() < 0.5
    assert abs(correlation.sum() / (40 * 39)) < 0.02
    assert own.std() == pytest.approx(1.0, abs=0.05)


def test_with_gsde_the_leaders_of_a_flock_act_by_one_perturbed_last_layer():
    venv = LeaderVecEnv(3, n_leaders=8, **{**OPTIONS, "n_boats": 20})
    venv.seed(0)
    venv.reset()
    policy = model_of(venv, use_sde=True, net_arch=[4], log_std_init=-1.0).policy
    deviations = policy.log_std.exp().detach().numpy()
    assert deviations.shape == (5, 1)
    flock, weights = venv.flock_of_slot, []
    for _ in range(40):
        rows = torch.as_tensor(venv.step(np.zeros((24, 1)))[0])
        with torch.no_grad():
            actions, _, log_prob = policy.forward(rows)
            distribution = policy.get_distribution(rows).distribution
            latent = policy.mlp_extractor.forward_actor(policy.extract_features(rows)).numpy()
        seen = np.hstack([latent, np.ones((24, 1))])
        # The probability is that of a sum of independent weights.
        np.testing.assert_allclose(
            distribution.stddev.numpy(), np.sqrt(seen**2 @ deviations**2), rtol=1e-4
        )
        assert torch.allclose(log_prob, distribution.log_prob(actions).sum(dim=1))
        found = (actions - distribution.mean).numpy()
        for number in range(3):
            own = flock == number
            solved, *_ = np.linalg.lstsq(seen[own], found[own], rcond=None)
            np.testing.assert_allclose(seen[own] @ solved, found[own], atol=1e-5)
            weights.append(solved[:, 0] / deviations[:, 0])
    # 2 s are four decisions.
    blocks = np.array(weights).reshape(10, 4, 3, 5)
    np.testing.assert_allclose(blocks, np.repeat(blocks[:, :1], 4, axis=1), atol=0.02)
    own = blocks[:, 0].reshape(30, 5)
    assert np.abs(np.corrcoef(own) - np.eye(30)).max() < 0.999
    assert own.std() == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize("use_sde", [False, True])
def test_ppo_learns_with_it_and_its_file_steers(tmp_path, use_sde):
    venv = LeaderVecEnv(4, n_leaders=2, episode_s=10.0, **OPTIONS)
    model = model_of(venv, use_sde=use_sde, net_arch=[8])
    before = [each.clone() for each in model.policy.parameters()]
    model.learn(2 * 8 * venv.num_envs)
    after = list(model.policy.parameters())
    assert any(not torch.equal(one, other) for one, other in zip(before, after, strict=True))
    model.save(tmp_path / "model.zip")
    rows = venv.reset()
    read = PPO.load(tmp_path / "model.zip", device="cpu")
    assert np.array_equal(
        read.predict(rows, deterministic=True)[0], model.predict(rows, deterministic=True)[0]
    )
    policy = flockenv.policies.load(tmp_path / "model.zip", trust=True)
    assert (policy.action_mode, policy.decision_period_s) == ("lean", 0.5)
    found = run_episodes(
        flockenv.FlockParameters(n_boats=6, n_leaders=2, pool="narrow"), policy, [0], 10.0
    )
    assert np.isfinite(found["signed_order"]).all()


def test_models_of_another_action_mode_are_refused():
    options = {"n_boats": 6, "n_leaders": 2, "pool": "narrow", "episode_s": 5.0}
    model = model_of(LeaderVecEnv(2, n_leaders=2, **OPTIONS))
    with pytest.raises(ParameterError, match=r"made for action_mode = 'lean', not 'rudder'"):
        evaluate_flocks(model, LeaderVecEnv(2, **options))
    with pytest.raises(ParameterError, match=r"'lean'.*'rudder'"):
        flockenv.simulate(flockenv.FlockParameters(n_leaders=2, n_boats=6), 0, 1.0, policy=model)


@pytest.mark.parametrize(
    ("hold_s", "message"),
    [(0.75, "0.5 and 1 s"), (0.2, "0.5 s is"), (0.0, "whole number"), (-1.0, "whole")],
)
def test_bad_times_are_refused(hold_s, message):
    with pytest.raises(ParameterError, match=message):
        shared_noise(LeaderVecEnv(2, **OPTIONS), hold_s)


def test_a_noise_is_held_for_whole_decisions():
    # After 2.5 decisions none would be drawn ever again.
    venv = LeaderVecEnv(2, n_leaders=2, **OPTIONS)
    noise = {**shared_noise(venv, 1.0), "hold_steps": 2.5}
    with pytest.raises(ParameterError, match="hold_steps"):
        PPO(SharedNoisePolicy, venv, policy_kwargs=noise)


def test_only_continuous_actions_of_leaders_are_accepted():
    levels = LeaderVecEnv(2, rudder_levels=5, **OPTIONS)
    with pytest.raises(ParameterError, match="continuous"):
        model_of(levels)
    with pytest.raises(TypeError, match="LeaderVecEnv"):
        shared_noise(type("Other", (), {"unwrapped": 1})(), 1.0)
    with pytest.raises(TypeError, match="LeaderVecEnv"):
        shared_noise(None, 1.0)
