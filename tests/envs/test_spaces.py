"""Law: spaces of equal shape and another meaning differ, so that libraries refuse by themselves."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import BLOCKS
from flockenv.envs.spaces import ObservationSpace

from .conftest import EVERY

OPTIONS = {"n_boats": 6, "n_leaders": 2, "episode_s": 1.0}
#: Options that leave the shape as it is, and change what a policy does.
MEANINGS = {
    "mirror": {"mirror_to_target": True},
    "rate": {"control_hz": 5.0},
    "heading": {"action_mode": "heading"},
    "lean": {"action_mode": "lean"},
    "period": {"decision_period_s": 0.5},
}
#: Options that a policy does not depend on.
TASKS = {
    "noise": {"bw_s": 0.5},
    "flock": {"n_boats": 9},
    "target": {"target": "ccw"},
    "reward": {"reward": {"jam": 1.0}},
    "physics": {"physics": "training"},
    "camera": {"dropout_rate": 0.1, "delay_frames": 1},
    "one step": {"decision_period_s": 0.1},
    "layout": {"observation": dict(BLOCKS)},
}


def space_of(env):
    """Return the observation space of one leader or of all, whatever the interface calls it."""
    if hasattr(env, "possible_agents"):
        return env.observation_space(env.possible_agents[0])
    return getattr(env, "single_observation_space", None) or env.observation_space


@pytest.fixture(params=EVERY.values(), ids=EVERY.keys())
def space(request):
    def made(**options):
        found = space_of(request.param(**{**OPTIONS, **options}))
        assert isinstance(found, ObservationSpace)
        return found

    return made


@pytest.mark.parametrize("options", MEANINGS.values(), ids=MEANINGS.keys())
def test_another_meaning_is_another_space(space, options):
    plain, other = space(), space(**options)
    assert plain.shape == other.shape
    assert plain != other
    assert other != plain
    assert other == space(**options)


@pytest.mark.parametrize("options", TASKS.values(), ids=TASKS.keys())
def test_another_task_has_the_same_space(space, options):
    assert space() == space(**options)


def test_copies_are_equal_and_differ_from_others(space):
    for options in ({}, *MEANINGS.values()):
        own = space(**options)
        for other in (copy.deepcopy(own), copy.copy(own), pickle.loads(pickle.dumps(own))):
            assert other == own
            assert (other == space()) == (options == {})


def test_leaders_side_by_side_are_not_one_leader():
    one = space_of(flockenv.LeadersEnv(**{**OPTIONS, "n_leaders": 1}))
    assert one == space_of(flockenv.parallel_env(**OPTIONS))
    assert one != space_of(flockenv.LeadersEnv(**OPTIONS))


def test_a_plain_box_says_nothing_of_its_meaning(space):
    own = space()
    box = gymnasium.spaces.Box(own.low, own.high, dtype=own.dtype)
    assert own == box
    assert box == own
    wider = gymnasium.spaces.Box(own.low - 1.0, own.high, dtype=own.dtype)
    assert own != wider
    assert wider != own
    assert own != gymnasium.spaces.Discrete(3)


def test_spaces_of_older_builds_have_the_defaults_of_what_they_do_not_name():
    own = space_of(flockenv.LeadersEnv(**OPTIONS))
    older = copy.deepcopy(own)
    del older.options["decision_period_s"], older.options["action_mode"]
    older.options["observation"] = {"neighbors": BLOCKS["neighbors"]}
    assert older == own
    assert older != space_of(flockenv.LeadersEnv(**OPTIONS, action_mode="heading"))


def test_the_words_of_a_refusal_name_what_differs():
    space = space_of(flockenv.LeadersEnv(**OPTIONS, observation={"neighbors": 2}, control_hz=5))
    words = str(space)
    assert "control_hz=5.0" in words
    assert "observation={'neighbors': 2}" in words
    assert "leaders=2" in words


def test_gymnasium_refuses_flocks_of_another_meaning():
    makes = [lambda: flockenv.LeadersEnv(**OPTIONS)]
    makes.append(lambda: flockenv.LeadersEnv(**OPTIONS, mirror_to_target=True))
    with pytest.raises(RuntimeError, match="mirror_to_target=True"):
        gymnasium.vector.SyncVectorEnv(makes)
    gymnasium.vector.SyncVectorEnv(makes[:1] * 2)


@pytest.mark.parametrize("options", MEANINGS.values(), ids=MEANINGS.keys())
def test_stable_baselines3_refuses_them_for_a_model(tmp_path, options):
    """Also a model that is loaded from a file, and a batch of Gymnasium's environments."""
    sb3 = pytest.importorskip("stable_baselines3")
    for make in (
        lambda **more: flockenv.sb3.LeaderVecEnv(2, **OPTIONS, **more),
        lambda **more: flockenv.LeadersEnv(**OPTIONS, **more),
    ):
        model = sb3.PPO("MlpPolicy", make(), n_steps=8, batch_size=8, device="cpu")
        with pytest.raises(ValueError, match="Observation spaces do not match"):
            model.set_env(make(**options))
        model.save(tmp_path / "model")
        with pytest.raises(ValueError, match="Observation spaces do not match"):
            sb3.PPO.load(tmp_path / "model", env=make(**options), device="cpu")
        other = sb3.PPO.load(tmp_path / "model", env=make(bw_s=0.5), device="cpu")
        assert np.isfinite(other.predict(other.env.reset())[0]).all()
