"""Law: an episode is a flock's, however many leaders have a slot in it."""

import json

import gymnasium
import numpy as np
import pytest

sb3 = pytest.importorskip("stable_baselines3")

from stable_baselines3 import PPO  # noqa: E402
from stable_baselines3.common.evaluation import evaluate_policy  # noqa: E402
from stable_baselines3.common.monitor import load_results  # noqa: E402
from stable_baselines3.common.vec_env import VecNormalize  # noqa: E402

from flockenv import FlockParameters, ParameterError  # noqa: E402
from flockenv.comparison import run_episodes  # noqa: E402
from flockenv.envs.registration import ENTRY_POINT  # noqa: E402
from flockenv.policies import SteeringLaw, load  # noqa: E402
from flockenv.sb3 import (  # noqa: E402
    FlockEvalCallback,
    FlockMonitor,
    LeaderVecEnv,
    PerFlock,
    evaluate_flocks,
)

FLOCK = {"n_boats": 9, "pool": "narrow"}
OPTIONS = {**FLOCK, "episode_s": 2.0}


def make(num_flocks=4, n_leaders=3, **options):
    return LeaderVecEnv(num_flocks, n_leaders=n_leaders, **{**OPTIONS, **options})


def returns_of(venv, policy, seed, episodes=1):
    """Each flock's return in its first episodes, added up by hand."""
    venv.seed(seed)
    observations, found = venv.reset(), []
    for _ in range(episodes):
        total = np.zeros(venv.num_flocks)
        for _ in range(20):
            observations, rewards, dones, _ = venv.step(policy.predict(observations)[0])
            total += np.bincount(venv.flock_of_slot, rewards) / np.bincount(venv.flock_of_slot)
        assert dones.all()
        found.append(total)
    return np.array(found)


def ppo(venv):
    return PPO("MlpPolicy", venv, n_steps=8, batch_size=24, n_epochs=1, seed=0, device="cpu")


def test_three_leaders_are_one_episode():
    # What goes wrong otherwise: one order, three episodes, no deviation.
    venv = make(num_flocks=1)
    with pytest.warns(UserWarning, match="not wrapped with a ``Monitor``"):
        counted, _ = evaluate_policy(
            SteeringLaw(), venv, n_eval_episodes=3, return_episode_rewards=True
        )
    assert len(counted) == 3
    assert len(set(counted)) == 1
    found = evaluate_flocks(SteeringLaw(), venv, n_eval_episodes=3)
    assert len(set(found.returns)) == 3
    assert found.lengths.tolist() == [20, 20, 20]


def test_returns_are_means_over_the_flocks_leaders():
    reward = {"signed_order": 1.0, "leader_velocity": 0.5}
    venv = make(n_leaders=[1, 3], reward=reward)
    expected = returns_of(venv, SteeringLaw(), 7)
    found = evaluate_flocks(SteeringLaw(), venv, n_eval_episodes=4, seed=7)
    np.testing.assert_allclose(found.returns, expected[0], rtol=1e-5)


def test_a_reward_of_a_flock_is_the_mean_over_its_leaders():
    options = {"n_leaders": [1, 3], "reward": {"leader_velocity": 1.0}}
    flocks, leaders = PerFlock(make(**options)), make(**options)
    for venv in (flocks, leaders):
        venv.seed(7)
        venv.reset()
    actions = np.linspace(-1.0, 1.0, leaders.num_envs)[:, None]
    for _ in range(5):
        found, each = flocks.step(actions)[1], leaders.step(actions)[1]
        expected = [each[leaders.flock_of_slot == flock].mean() for flock in range(4)]
        np.testing.assert_allclose(found, expected, rtol=1e-6)
    assert not np.allclose(found, each[[0, 1, 4, 5]])


def test_the_order_is_that_of_a_comparison_and_has_an_interval():
    venv = make(n_leaders=2, episode_s=60.0)
    found = evaluate_flocks(SteeringLaw(), venv, n_eval_episodes=4, seed=7)
    parameters = FlockParameters.preset("simulation").replace(**FLOCK, n_leaders=2)
    expected = run_episodes(parameters, SteeringLaw(), range(7, 11), 60.0)["signed_order"]
    np.testing.assert_allclose(found.signed_order, expected, atol=1e-9)
    # Student's quantile for four values is 3.182.
    half = 3.182446 * found.signed_order.std(ddof=1) / 2
    assert found.interval == pytest.approx((found.mean - half, found.mean + half))
    low, high = found.interval
    text = f"signed order {found.mean:.3f} [{low:.3f}, {high:.3f}] in 4 episodes"
    assert str(found) == text


def test_other_environments_are_refused():
    from stable_baselines3.common.vec_env import DummyVecEnv

    import flockenv

    other = DummyVecEnv([lambda: flockenv.LeadersEnv(**OPTIONS)])
    for env, kind in (
        (other, "DummyVecEnv"),
        ("flockenv/Leaders-v0", "str"),
        (None, "NoneType"),
        (flockenv.LeadersEnv(**OPTIONS), "LeadersEnv"),
    ):
        with pytest.raises(TypeError, match=f"a LeaderVecEnv is needed, not {kind}"):
            evaluate_flocks(SteeringLaw(), env)
    with pytest.raises(TypeError, match="seed must be an integer"):
        FlockEvalCallback(flockenv.sb3.LeaderVecEnv(**OPTIONS), seed="1")


def test_evaluations_of_nothing_and_of_leaders_of_another_pool_are_refused():
    for episodes in (0, -1):
        with pytest.raises(ParameterError, match="n_eval_episodes"):
            evaluate_flocks(SteeringLaw(), make(1), episodes)
    law = load("learned", pool="wide")
    options = {"action_mode": law.action_mode, "decision_period_s": law.decision_period_s}
    with pytest.raises(ParameterError, match="made for pool = 'wide'"):
        evaluate_flocks(law, make(1, observation=law.observation, **options), 1)


def test_callback_evaluates_flocks_and_keeps_the_best(tmp_path):
    callback = FlockEvalCallback(
        make(),
        seed=11,
        n_eval_episodes=4,
        eval_freq=8,
        log_path=str(tmp_path),
        best_model_save_path=str(tmp_path),
        verbose=0,
    )
    model = ppo(make())
    model.learn(3 * 8 * 12, callback=callback)
    stored = np.load(tmp_path / "evaluations.npz")
    assert stored["results"].shape == (3, 4)
    # Each evaluation has its own episodes alone.
    np.testing.assert_allclose(callback.evaluation.returns, stored["results"][-1], rtol=1e-6)
    # The last evaluation, by hand, before the update that followed it.
    assert (tmp_path / "best_model.zip").is_file()
    best = PPO.load(tmp_path / "best_model", device="cpu")
    best_return = returns_of(make(), best, 11).mean()
    assert best_return == pytest.approx(stored["results"].mean(axis=1).max(), rel=1e-4)


def test_callback_follows_normalized_training():
    training = VecNormalize(make(), gamma=0.9)
    evaluation = VecNormalize(PerFlock(make()), training=False, norm_reward=False, gamma=0.9)
    callback = FlockEvalCallback(evaluation, n_eval_episodes=4, eval_freq=8, verbose=0)
    ppo(training).learn(8 * 12, callback=callback)
    np.testing.assert_array_equal(evaluation.obs_rms.mean, training.obs_rms.mean)
    assert np.isfinite(callback.last_mean_reward)


def test_monitor_file_has_a_row_per_flock(tmp_path):
    venv = FlockMonitor(make(), str(tmp_path / "run"), ("signed_order", "ordering_time_s"))
    ppo(venv).learn(12 * 24)
    venv.close()
    rows = load_results(str(tmp_path))
    assert list(rows["l"]) == [20] * 4
    assert rows["r"].nunique() == 4
    assert {"t", "signed_order", "ordering_time_s"} <= set(rows.columns)


def test_a_monitor_file_names_the_environment(tmp_path):
    easy = gymnasium.spec("flockenv/Order-easy-v0").kwargs
    made = {
        "flockenv/Order-easy-v0": LeaderVecEnv(2, **easy),
        "flockenv/Leaders-v0": PerFlock(LeaderVecEnv(2)),
        "own-v0": LeaderVecEnv(2, **{**easy, "bw_s": 0.25}),
        "None": LeaderVecEnv(2, **{**easy, "n_leaders": [1, 4]}),
    }
    gymnasium.register("own-v0", ENTRY_POINT, kwargs={**easy, "bw_s": 0.25})
    try:
        for place, (env_id, venv) in enumerate(made.items()):
            FlockMonitor(venv, str(tmp_path / f"{place}")).close()
            with open(tmp_path / f"{place}.monitor.csv", encoding="utf-8") as file:
                assert json.loads(file.readline()[1:])["env_id"] == env_id
    finally:
        del gymnasium.registry["own-v0"]


def test_the_callback_prints_what_evaluate_flocks_does(capsys):
    venv = make()
    callback = FlockEvalCallback(make(), seed=9, n_eval_episodes=6, eval_freq=8, verbose=1)
    model = ppo(venv).learn(96, callback)
    found = evaluate_flocks(model, make(), 6, seed=9)
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == 1 + (96 // 12 // 8 - 1)
    assert printed[0].startswith("96 steps: signed order ")
    assert printed[-1].removesuffix(", the best so far").endswith("in 6 episodes")
    assert callback.verbose == 1
    # The policy has learned since the evaluation.
    assert callback.evaluation.signed_order.shape == found.signed_order.shape
    assert callback.evaluation.lengths.tolist() == [20] * 6
    logged = model.logger.name_to_value.get("eval/signed_order", callback.evaluation.mean)
    assert np.isclose(logged, callback.evaluation.mean, equal_nan=True)
    quiet = FlockEvalCallback(make(), seed=9, n_eval_episodes=6, eval_freq=8, verbose=0)
    ppo(venv).learn(96, quiet)
    assert capsys.readouterr().out == ""
    assert str(quiet.evaluation) in printed[0]


def test_the_monitors_keywords_may_be_gone_through_once(tmp_path):
    venv = FlockMonitor(make(), str(tmp_path / "flocks"), iter(["signed_order", "bw_s"]))
    venv.reset()
    for _ in range(20):
        venv.step(np.zeros((venv.num_envs, 1)))
    venv.close()
    rows = load_results(str(tmp_path))
    assert len(rows) == 4
    assert rows["bw_s"].notna().all()
    with pytest.raises(TypeError, match="summary_keywords must be a sequence"):
        FlockMonitor(make(), str(tmp_path / "other"), "signed_order")
