"""Law: in the centralized-critic example the critic reads the state, and the actor does not."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")


def test_a_short_run(script, tmp_path):
    script.main(["--samples", "500", "--flocks", "1", "--out", str(tmp_path / "policy")])
    assert (tmp_path / "policy.zip").is_file()


def test_who_sees_what(script):
    model = script.train(300, 2, 0, n_boats=8, n_leaders=2, episode_s=5.0)
    observations = model.get_env().reset()
    other_state = observations.copy()
    other_state[:, model.policy.seen :] += 0.5
    other_view = observations.copy()
    other_view[:, : model.policy.seen] += 0.5

    def values(rows):
        return model.policy.predict_values(model.policy.obs_to_tensor(rows)[0]).detach().numpy()

    actions = model.predict(observations, deterministic=True)[0]
    np.testing.assert_array_equal(actions, model.predict(other_state, deterministic=True)[0])
    assert (actions != model.predict(other_view, deterministic=True)[0]).any()
    assert (values(observations) != values(other_state)).any()


def test_last_observations_have_the_last_state(script):
    env = script.WithState(script.LeaderVecEnv(2, n_boats=8, n_leaders=2, episode_s=0.3))
    env.reset()
    for _ in range(3):
        _, _, dones, infos = env.step(np.zeros((4, 1)))
    assert dones.all()
    for info in infos:
        assert info["terminal_observation"] in env.observation_space
        # The part of the episode that is over stands last.
        assert info["terminal_observation"][-1] == 1.0
