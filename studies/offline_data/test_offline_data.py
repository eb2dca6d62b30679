"""Law: a data set holds what its policy did, so that a clone of the tuned law is found in it."""

import numpy as np
import pytest

from flockenv import LeadersEnv, ParameterError
from flockenv.envs.observation import observation_entries

minari = pytest.importorskip("minari")


@pytest.fixture(scope="module")
def script(script, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MINARI_DATASETS_PATH", str(tmp_path_factory.mktemp("minari")))
        patch.setattr(script, "BLOCK", 3)  # Five episodes in two blocks.
        script.main(["--flock-hours", str(5 / 30), "--minutes", "2"])
        yield script


def test_episodes_have_the_environment_steps(script):
    dataset = script.checked("flockenv/wide/learned-v0")
    assert (dataset.total_episodes, dataset.total_steps) == (5, 5 * 300)
    env = dataset.recover_environment()
    for episode in dataset.iterate_episodes():
        assert episode.observations.shape == (301, *env.observation_space.shape)
        assert episode.actions.shape == (300, *env.action_space.shape)
        assert episode.truncations.tolist() == [False] * 299 + [True]
        assert not episode.terminations.any()


def test_an_episode_is_that_of_its_seed(script):
    seed = script.POLICY_SEEDS["offline data"].seeds(1, start=4)[0]
    env = LeadersEnv(**script.options_of(120.0))
    seen, _ = env.reset(seed=seed)
    episode = script.checked("flockenv/wide/tuned-v0")[4]
    for step, action in enumerate(episode.actions):
        assert (seen == episode.observations[step]).all()
        seen, reward, *_ = env.step(action)
        assert reward == pytest.approx(episode.rewards[step])
    assert (seen == episode.observations[-1]).all()


def test_a_clone_of_the_tuned_law_steers_as_it_does(script):
    # Behavior cloning: the rudder as a linear function of the own state, one for each direction of
    # motion, because a rudder works in reverse on a backing boat.
    names = [each.name for each in observation_entries(script.LAYOUT["observation"])]
    forward = names.index("forward_velocity")

    def inputs(episode):
        rows = episode.observations[:-1].reshape(-1, len(names))
        rows = np.column_stack([rows, np.ones(len(rows))])
        back = rows[:, [forward]] < 0.0
        return np.column_stack([rows * back, rows * ~back])

    *known, last = script.checked("flockenv/wide/tuned-v0").iterate_episodes()
    seen = np.concatenate([inputs(each) for each in known])
    rudders = np.concatenate([each.actions.ravel() for each in known])
    weights = np.linalg.lstsq(seen, rudders, rcond=None)[0]
    cloned = np.clip(inputs(last) @ weights, -1.0, 1.0)
    assert np.corrcoef(cloned, last.actions.ravel())[0, 1] > 0.85


def test_a_data_set_of_another_version_is_refused(script):
    dataset = minari.load_dataset("flockenv/wide/random-v0")
    dataset.storage.update_metadata({"results_version": 1})
    with pytest.raises(ParameterError, match="flockenv/wide/random-v0 has results version 1"):
        script.checked("flockenv/wide/random-v0")
