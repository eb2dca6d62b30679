"""Law: a slot shows one leader and its flock; bw_s and target change for the episodes to come."""

import pickle

import pytest

import flockenv

sb3 = pytest.importorskip("stable_baselines3")

from stable_baselines3 import PPO  # noqa: E402
from stable_baselines3.common.callbacks import BaseCallback  # noqa: E402
from stable_baselines3.common.env_util import is_wrapped  # noqa: E402
from stable_baselines3.common.monitor import Monitor  # noqa: E402

from flockenv.sb3 import LeaderVecEnv  # noqa: E402

from .conftest import started, steps  # noqa: E402

STEPS = 20


def make(num_flocks=3, **options):
    return LeaderVecEnv(num_flocks, n_leaders=2, n_boats=9, episode_s=2.0, **options)


def test_attributes_and_methods_of_slots():
    venv = started(make())
    assert venv.get_attr("flock_index") == [0, 0, 1, 1, 2, 2]
    assert venv.get_attr("flock_index", indices=[5, 0]) == [2, 0]
    assert not venv.has_attr("note")
    with pytest.raises(AttributeError):
        venv.get_attr("nonsense")
    assert [episode["step"] for episode in venv.env_method("episode", indices=[0, 1])] == [0, 0]
    assert venv.env_is_wrapped(Monitor) == [False] * 6
    assert is_wrapped
    assert venv.get_attr("render_mode") == [None] * 6


def bw_s_of(venv):
    return [episode["bw_s"] for episode in venv.env_method("episode")]


def test_set_attr_holds_for_the_episodes_that_start_from_then_on():
    venv = started(make(num_flocks=2), seed=0)
    own = venv.slots[0].parameters.bw_s
    assert venv.get_attr("bw_s") == [own] * 4
    assert venv.get_attr("target") == ["cw"] * 4
    steps(venv, 3)
    before = venv.get_state()
    venv.set_attr("bw_s", 2.0)
    venv.set_attr("target", "ccw", indices=[2, 3])
    assert venv.get_attr("bw_s") == [2.0] * 4
    assert venv.get_attr("target") == ["cw", "cw", "ccw", "ccw"]
    # The episode under way goes on as it is, and a copy goes on alike.
    copies = (venv.clone(), pickle.loads(pickle.dumps(venv)), make(num_flocks=2))
    copies[2].set_state(venv.get_state())
    assert venv.get_state() != before
    assert bw_s_of(venv) == [own] * 4
    last = steps(venv, STEPS - 3)[-1]
    assert [info["episode_summary"]["bw_s"] for info in last[3]] == [own] * 4
    assert bw_s_of(venv) == [2.0] * 4
    assert [info["bw_s"] for info in venv.reset_infos] == [2.0] * 4
    assert [info["target"] for info in venv.reset_infos] == ["cw", "cw", "ccw", "ccw"]
    for copy in copies:
        steps(copy, STEPS - 3)
        assert copy.get_state() == venv.get_state()
        assert copy.get_attr("bw_s") == [2.0] * 4
    # Also after a reset, which may ask for another one once.
    venv.set_options({"bw_s": 0.7})
    venv.reset()
    assert bw_s_of(venv) == [0.7] * 4
    steps(venv, STEPS)
    assert bw_s_of(venv) == [2.0] * 4
    venv.set_attr("bw_s", (x for x in (0.25, 0.75)))
    venv.reset()
    assert venv.get_attr("bw_s") == [(0.25, 0.75)] * 4
    assert len({*bw_s_of(venv)}) == 2
    assert all(0.25 <= bw_s <= 0.75 for bw_s in bw_s_of(venv))
    snapshot = flockenv.Flock(venv.slots[0].parameters, 9).snapshot()
    venv.set_options({"snapshot": snapshot})
    venv.reset()
    assert bw_s_of(venv) == [own] * 4
    venv.set_attr("target", ["ccw", "cw"])
    venv.reset()
    assert venv.get_attr("target") == [("ccw", "cw")] * 4
    assert [info["target"] for info in venv.reset_infos] == [("ccw", "cw")] * 4


def test_a_curriculum_within_one_training():
    venv, seen = make(num_flocks=2, bw_s=0.1), []

    class Curriculum(BaseCallback):
        def _on_step(self):
            seen.extend(
                info["episode_summary"]["bw_s"]
                for info in self.locals["infos"]
                if "episode" in info
            )
            return True

        def _on_rollout_end(self):
            self.training_env.set_attr("bw_s", self.training_env.get_attr("bw_s")[0] + 0.1)

    model = PPO("MlpPolicy", venv, n_steps=STEPS, batch_size=16, n_epochs=1, device="cpu")
    model.learn(3 * STEPS * venv.num_envs, Curriculum())
    # An episode that starts with the last step of a rollout has what held then.
    assert seen == pytest.approx([0.1, 0.1, 0.1, 0.1, 0.2, 0.2])


@pytest.mark.parametrize("name", ["leader_index", "flock_index", "n_boats", "c4", "BW_S", "note"])
def test_set_attr_of_anything_else_says_what_it_takes(name):
    venv = make()
    before = vars(venv.slots[0]).copy()
    with pytest.raises(AttributeError, match=f"'{name}' cannot be set.*bw_s and target"):
        venv.set_attr(name, 1)
    with pytest.raises(AttributeError):
        setattr(venv.slots[0], name, 1)
    with pytest.raises(AttributeError):
        venv.env_method("__setattr__", name, 1)
    assert vars(venv.slots[0]) == before
    assert not venv.has_attr(name) or name.endswith("index")


def test_set_attr_refuses_what_no_episode_can_have():
    venv = started(make(num_flocks=2), seed=0)
    before = venv.get_state()
    for name, value, indices in (
        ("bw_s", -1.0, None),
        ("bw_s", (0.5, 0.1), None),
        ("bw_s", float("nan"), None),
        ("target", "north", None),
        ("target", ["cw"], None),
        ("bw_s", 1.0, 0),
        ("bw_s", 1.0, [0, 1, 2]),
    ):
        with pytest.raises(flockenv.ParameterError, match=name):
            venv.set_attr(name, value, indices)
    for name, value in (("bw_s", "long"), ("bw_s", None), ("target", 7), ("bw_s", [1.0])):
        with pytest.raises((TypeError, flockenv.ParameterError), match=name):
            venv.set_attr(name, value)
    with pytest.raises(IndexError):
        venv.set_attr("bw_s", 1.0, [9])
    assert venv.get_state() == before
    venv.set_attr("bw_s", 1.0, iter([1, 0]))
    assert venv.get_attr("bw_s")[1:3] == [1.0, venv.slots[0].parameters.bw_s]
