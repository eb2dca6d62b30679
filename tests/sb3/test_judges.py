"""Law: a model is judged on the task of its training, and a training goes on as it began."""

import json
from functools import partial

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import StopTrainingOnNoModelImprovement
from stable_baselines3.common.monitor import load_results
from stable_baselines3.common.vec_env import VecEnvWrapper, VecFrameStack, VecNormalize

from flockenv import ParameterError
from flockenv.policies import DampedLaw, ModelPolicy, SteeringLaw, WrappedPolicy
from flockenv.sb3 import (
    FlockEvalCallback,
    FlockMonitor,
    LeaderVecEnv,
    PerFlock,
    SharedNoisePolicy,
    evaluate_flocks,
    shared_noise,
)

OPTIONS = {"n_boats": 9, "pool": "narrow", "n_leaders": 3, "episode_s": 2.0}
#: Options that leave the shapes as they are.
OTHERS = {
    "mirror": {"mirror_to_target": True},
    "rate": {"control_hz": 5.0},
    "heading": {"action_mode": "heading"},
    "period": {"decision_period_s": 0.5},
}
SAME_ORDER = "evaluate it in wrappers in the same order"
#: It tells policies apart at once.
EFFORT = {"reward": {"rudder_effort": 1.0}}
LOOKS = {
    "plain": lambda venv: venv,
    "per flock": PerFlock,
    "normalized": lambda venv: VecNormalize(PerFlock(venv), training=False),
}


def make(num_flocks=4, **options):
    return LeaderVecEnv(num_flocks, **{**OPTIONS, **options})


def stacked(venv):
    return VecFrameStack(venv, 2)


def normalized_and_stacked():
    return stacked(VecNormalize(make()))


def ppo(venv, policy="MlpPolicy", **options):
    return PPO(policy, venv, n_steps=8, batch_size=24, n_epochs=1, seed=0, device="cpu", **options)


def evaluation(venv, folder=None, **options):
    given = {"n_eval_episodes": 4, "eval_freq": 8, "verbose": 0, "seed": 11, **options}
    return FlockEvalCallback(venv, log_path=folder, best_model_save_path=folder, **given)


@pytest.mark.parametrize("options", OTHERS.values(), ids=OTHERS.keys())
def test_flocks_of_another_meaning_judge_no_model(options, tmp_path):
    model = ppo(make())
    for judged in (model, model.policy, ModelPolicy(model)):
        with pytest.raises(ParameterError, match=f"made for {next(iter(options))} = "):
            evaluate_flocks(judged, make(**options), 4)
    callback = evaluation(make(**options), str(tmp_path / "best"))
    with pytest.raises(ParameterError, match=f"made for {next(iter(options))} = "):
        model.learn(96, callback)
    assert model.num_timesteps == 0
    assert not list(tmp_path.rglob("*.zip"))


@pytest.mark.parametrize(
    ("training", "flocks", "words"),
    [
        (make, partial(make, rudder_levels=5), r"its action space is Box.*not Discrete"),
        (make, lambda: VecNormalize(PerFlock(make())), "evaluate it without VecNormalize"),
        (lambda: stacked(make()), make, "its observation space is"),
        (normalized_and_stacked, lambda: stacked(make()), SAME_ORDER),
        (normalized_and_stacked, lambda: VecNormalize(stacked(make())), SAME_ORDER),
    ],
)
def test_a_model_is_judged_in_the_wrappers_of_its_training_alone(training, flocks, words):
    model = ppo(training())
    assert len(evaluate_flocks(model, training(), 4).returns) == 4
    with pytest.raises(ParameterError, match=words):
        evaluate_flocks(model, flocks(), 4)


@pytest.mark.parametrize("options", OTHERS.values(), ids=OTHERS.keys())
def test_a_wrapper_that_says_no_meaning_hides_none(options):
    """Stacked frames have a plain space; the flocks under them are compared."""
    venv = VecFrameStack(make(), 2)
    model = ppo(venv)
    words = f"made for {next(iter(options))} = "
    with pytest.raises(ParameterError, match=words):
        evaluate_flocks(model, VecFrameStack(make(**options), 2), 4)
    with pytest.raises(ParameterError, match=words):
        model.learn(96, evaluation(VecFrameStack(make(**options), 2)))
    with pytest.raises(ParameterError, match="the model was trained in ObservationSpace"):
        WrappedPolicy(model, lambda venv: VecFrameStack(venv, 2), make(**options))


def test_statistics_that_are_put_on_other_flocks_hide_no_meaning(tmp_path):
    """A `VecNormalize` from a file keeps its space, and stable-baselines3 compares shapes alone."""
    training = VecNormalize(make())
    model = ppo(training)
    training.save(str(tmp_path / "statistics"))
    model.save(tmp_path / "model")
    other = VecNormalize.load(str(tmp_path / "statistics"), make(mirror_to_target=True))
    model = PPO.load(tmp_path / "model", env=other, device="cpu")
    with pytest.raises(ParameterError, match="made for mirror_to_target = "):
        evaluate_flocks(model, make(), 4)


def test_a_model_with_its_wrapper_is_judged_in_plain_flocks():
    model = ppo(stacked(make(**EFFORT))).learn(96)
    expected = evaluate_flocks(model, stacked(make(**EFFORT)), 8, seed=7)
    policy = WrappedPolicy(model, stacked, make(**EFFORT))
    found = evaluate_flocks(policy, make(**EFFORT), 8, seed=7)
    np.testing.assert_allclose(found.returns, expected.returns, rtol=1e-5)
    with pytest.raises(ParameterError, match="made for mirror_to_target"):
        evaluate_flocks(policy, make(mirror_to_target=True), 4)


def test_policies_are_judged_in_what_they_say_and_no_more():
    evaluate_flocks(SteeringLaw(), make(control_hz=5.0), 4)
    evaluate_flocks(SteeringLaw(mirror_to_target=True), make(mirror_to_target=True), 4)
    for law, options in (
        (SteeringLaw(), {"mirror_to_target": True}),
        (SteeringLaw(observation={"neighbors": 2}), {}),
        (DampedLaw(), {"observation": {"order": False}}),
    ):
        with pytest.raises(ParameterError, match="made for"):
            evaluate_flocks(law, make(**options), 4)


def normalized_model():
    training = VecNormalize(make(**EFFORT), gamma=0.9)
    return ppo(training).learn(96 * 3)


def returns_by_hand(model, seed):
    """Each flock's return in its first episode, on observations normalized as in the training."""
    venv, normalizing = make(**EFFORT), model.get_vec_normalize_env()
    venv.seed(seed)
    rows, total = venv.reset(), np.zeros(4)
    for _ in range(20):
        actions, _ = model.predict(normalizing.normalize_obs(rows), deterministic=True)
        rows, rewards, *_ = venv.step(actions)
        total += rewards.reshape(4, 3).mean(axis=1)
    return total


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS.keys())
def test_a_model_that_saw_normalized_observations_sees_them_when_it_is_judged(look):
    model = normalized_model()
    expected = returns_by_hand(model, 7)
    for judged in (model, ModelPolicy(model)):
        found = evaluate_flocks(judged, look(make(**EFFORT)), 4, seed=7)
        np.testing.assert_allclose(found.returns, expected, rtol=1e-5)
    raw = evaluate_flocks(model.policy, make(**EFFORT), 4, seed=7)
    assert not np.allclose(raw.returns, expected, rtol=1e-3)


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS.keys())
def test_a_callback_judges_on_normalized_observations(look):
    model = ppo(VecNormalize(make(**EFFORT), gamma=0.9))
    callback = evaluation(look(make(**EFFORT)), seed=7)
    judged = []
    store = callback._store
    callback._store = lambda found: judged.append(returns_by_hand(model, 7)) or store(found)
    model.learn(96, callback)
    np.testing.assert_allclose(callback.evaluation.returns, judged[-1], rtol=1e-5)


def test_an_evaluation_teaches_no_statistics():
    """Also on the flocks of the training: what the model sees would drift while it is judged."""
    training = VecNormalize(make(**EFFORT), gamma=0.9)
    model = ppo(training).learn(96)
    mean, count = training.obs_rms.mean.copy(), training.obs_rms.count
    for flocks in (training, VecNormalize(PerFlock(make(**EFFORT)))):
        evaluate_flocks(model, flocks, 4, seed=7)
        assert flocks.training
        np.testing.assert_array_equal(flocks.obs_rms.mean, mean)
        assert flocks.obs_rms.count == count


@pytest.mark.parametrize(
    "options", [{"norm_obs": False}, {"clip_obs": 0.5}, {"epsilon": 1.0}], ids=lambda each: [*each]
)
def test_flocks_that_normalize_in_another_way_normalize_as_the_training(options):
    model = normalized_model()
    flocks = VecNormalize(make(**EFFORT), training=False, **options)
    found = evaluate_flocks(model, flocks, 4, seed=7)
    np.testing.assert_allclose(found.returns, returns_by_hand(model, 7), rtol=1e-5)


def test_rewards_alone_may_be_normalized():
    def rewards_alone(venv):
        return VecNormalize(venv, norm_obs=False, gamma=0.9)

    for model in (ppo(make(**EFFORT)), ppo(rewards_alone(make(**EFFORT))).learn(96)):
        plain = evaluate_flocks(model, make(**EFFORT), 4, seed=7)
        found = evaluate_flocks(model, rewards_alone(make(**EFFORT)), 4, seed=7)
        np.testing.assert_array_equal(found.returns, plain.returns)


def test_a_model_that_lost_its_normalization_is_judged_in_none_but_that(tmp_path):
    model = normalized_model()
    model.save(tmp_path / "model")
    model.get_vec_normalize_env().save(str(tmp_path / "statistics"))
    expected = returns_by_hand(model, 7)
    for options in ({}, {"env": make(**EFFORT)}):
        alone = PPO.load(tmp_path / "model", device="cpu", **options)
        for judged in (alone, lambda alone=alone: ModelPolicy(alone)):
            with pytest.raises(ParameterError, match="trained in VecNormalize and loaded without"):
                evaluate_flocks(judged() if callable(judged) else judged, make(**EFFORT), 4)
    alone = PPO.load(tmp_path / "model", device="cpu")
    own = VecNormalize.load(str(tmp_path / "statistics"), make(**EFFORT))
    found = evaluate_flocks(alone, own, 4, seed=7)
    np.testing.assert_allclose(found.returns, expected, rtol=1e-5)


class Remembering:
    """A recurrent policy: it counts, for each leader, the steps of its episode."""

    def __init__(self):
        self.counts = []

    def predict(self, observation, state=None, episode_start=None, deterministic=True):
        assert episode_start.shape == (len(observation),)
        before = np.zeros(len(observation)) if state is None else state
        state = np.where(episode_start, 0, before) + 1
        self.counts.append(state)
        return np.zeros((len(observation), 1)), state


def test_recurrent_models_are_judged_with_the_starts_of_their_leaders_episodes():
    policy = Remembering()
    found = evaluate_flocks(policy, make(2, n_leaders=[1, 3]), 4)
    assert found.lengths.tolist() == [20] * 4
    steps = [*range(1, 21)] * 2
    np.testing.assert_array_equal(policy.counts, np.repeat(steps, 4).reshape(40, 4))


def test_the_best_model_is_the_one_of_the_highest_order(tmp_path):
    """Not of the highest return: rewards may say something else."""
    options = {"episode_s": 30.0, "reward": {"signed_order": -1.0}}
    callback = evaluation(make(**options), str(tmp_path), n_eval_episodes=4)
    ppo(make(**options), learning_rate=0.05).learn(96 * 4, callback)
    stored = np.load(tmp_path / "evaluations.npz")
    assert stored["signed_order"].shape == stored["results"].shape == (4, 4)
    orders = stored["signed_order"].mean(axis=1)
    np.testing.assert_array_equal(stored["signed_order"][-1], callback.evaluation.signed_order)
    assert callback.best_signed_order == orders.max()
    best = evaluate_flocks(
        PPO.load(tmp_path / "best_model", device="cpu"), make(**options), 4, seed=11
    )
    assert best.mean == pytest.approx(orders.max(), abs=1e-6)
    assert orders.argmax() != stored["results"].mean(axis=1).argmax()
    assert callback.best_mean_reward == stored["results"].mean(axis=1)[orders.argmax()]


class Successes(VecEnvWrapper):
    def reset(self):
        return self.venv.reset()

    def step_wait(self):
        step = self.venv.step_wait()
        for info in step[3]:
            info["is_success"] = True
        return step


def test_a_training_that_goes_on_keeps_its_successes(tmp_path):
    model = ppo(make())
    for _ in range(2):
        successes = evaluation(Successes(make()), str(tmp_path))
        model.learn(96, successes, reset_num_timesteps=False)
    stored = np.load(tmp_path / "evaluations.npz")
    assert stored["successes"].shape == stored["results"].shape == (2, 4)


def test_a_training_that_goes_on_goes_on_with_its_evaluations_and_its_best(tmp_path):
    options = {"episode_s": 30.0}
    model = ppo(make(**options))
    first = evaluation(make(**options), str(tmp_path))
    model.learn(96 * 2, first)
    before = dict(np.load(tmp_path / "evaluations.npz"))
    model.save(tmp_path / "model")
    model = PPO.load(tmp_path / "model", env=make(**options), device="cpu")
    second = evaluation(make(**options), str(tmp_path))
    stored = (tmp_path / "best_model.zip").stat().st_mtime_ns
    model.learn(96 * 2, second, reset_num_timesteps=False)
    after = np.load(tmp_path / "evaluations.npz")
    assert after["timesteps"].tolist() == [96, 192, 288, 384]
    for name, rows in before.items():
        np.testing.assert_array_equal(after[name][:2], rows)
    orders = after["signed_order"].mean(axis=1)
    assert second.best_signed_order == orders.max()
    is_better = orders[2:].max() > orders[:2].max()
    assert ((tmp_path / "best_model.zip").stat().st_mtime_ns != stored) == is_better
    with pytest.raises(ParameterError, match="has 4 episodes in each evaluation"):
        model.learn(
            96,
            evaluation(make(**options), str(tmp_path), n_eval_episodes=8),
            reset_num_timesteps=False,
        )
    # One that starts again starts its file again.
    ppo(make(**options)).learn(96, evaluation(make(**options), str(tmp_path)))
    assert np.load(tmp_path / "evaluations.npz")["timesteps"].tolist() == [96]


@pytest.mark.parametrize("name", ["evaluations.npz", "best_model.zip"])
def test_files_of_an_evaluation_that_somebody_protected_stay(tmp_path, name):
    (tmp_path / name).write_text("somebody's")
    (tmp_path / name).chmod(0o444)
    model = ppo(make())
    with pytest.raises(PermissionError, match="protected against writing"):
        model.learn(96, evaluation(make(), str(tmp_path)))
    assert model.num_timesteps == 0
    assert (tmp_path / name).read_text() == "somebody's"


def test_a_damaged_file_of_evaluations_is_named(tmp_path):
    model = ppo(make()).learn(96)
    (tmp_path / "evaluations.npz").write_bytes(b"PK")
    words = r"evaluations\.npz is not a complete, undamaged \.npz file"
    with pytest.raises(ParameterError, match=words):
        model.learn(96, evaluation(make(), str(tmp_path)), reset_num_timesteps=False)


def test_callbacks_of_an_evaluation_are_called():
    stop = StopTrainingOnNoModelImprovement(max_no_improvement_evals=1, min_evals=0)
    model = ppo(make(), learning_rate=0.0)
    model.learn(96 * 9, evaluation(make(), callback_after_eval=stop))
    assert model.num_timesteps < 96 * 9


def test_a_monitor_file_that_has_episodes_is_neither_lost_nor_mixed_up(tmp_path):
    def trained(**options):
        venv = FlockMonitor(make(), str(tmp_path / "run"), ("signed_order",), **options)
        ppo(venv).learn(12 * 24)
        venv.close()
        return load_results(str(tmp_path))

    first = trained()
    assert len(first) == 4
    with pytest.raises(ParameterError, match="override_existing=True replaces them, False adds"):
        trained()
    both = trained(override_existing=False)
    assert len(both) == 8
    np.testing.assert_array_equal(both[["r", "l"]][:4], first[["r", "l"]])
    # One clock for both: the curve goes on.
    assert both["t"].is_monotonic_increasing
    assert both["t"][4] > both["t"][3]
    with pytest.raises(ParameterError, match="has the columns r, l, t, signed_order, and not"):
        FlockMonitor(make(), str(tmp_path / "run"), ("psi_o",), override_existing=False)
    assert len(trained(override_existing=True)) == 4
    with open(tmp_path / "run.monitor.csv", encoding="utf-8") as file:
        assert json.loads(file.readline()[1:])["env_id"] == "None"
    (tmp_path / "other.monitor.csv").write_text("a,b\n1,2\n3,4\n")
    with pytest.raises(ParameterError, match="is not a monitor file"):
        FlockMonitor(make(), str(tmp_path / "other"), override_existing=False)


@pytest.mark.parametrize("override_existing", [None, False])
def test_a_monitor_file_without_episodes_is_started(tmp_path, override_existing):
    for _ in range(2):
        venv = FlockMonitor(make(), str(tmp_path), (), override_existing)
        venv.close()
    assert (tmp_path / "monitor.csv").read_text().count("t_start") == 1
    venv = FlockMonitor(make(), str(tmp_path), (), override_existing)
    ppo(venv).learn(12 * 24)
    venv.close()
    assert len(load_results(str(tmp_path))) == 4


def test_a_shared_noise_is_for_the_flocks_that_it_was_made_for(tmp_path):
    model = ppo(make(), SharedNoisePolicy, policy_kwargs=shared_noise(make(), 0.5))
    model.save(tmp_path / "model")
    more = make(6)
    other = PPO.load(tmp_path / "model", env=more, device="cpu")
    # It may be judged there, but not go on to learn.
    evaluate_flocks(other, make(6), 6)
    other.predict(more.reset(), deterministic=False)
    with pytest.raises(ParameterError, match=r"18 leaders are not accepted.*shared_noise"):
        other.learn(18 * 8)
    shared = {**other.policy_kwargs, **shared_noise(more, 0.5)}
    other = PPO.load(
        tmp_path / "model", env=more, device="cpu", custom_objects={"policy_kwargs": shared}
    )
    other.learn(18 * 8)
    assert other.policy.action_dist.noise._flock_of_slot.tolist() == more.flock_of_slot.tolist()
