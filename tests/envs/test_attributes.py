"""Law: an option that is set as an attribute is an error that says what sets it, never ignored."""

import copy
import pickle
import re
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv.envs.options import NAMES, OPTIONS
from flockenv.envs.reset_options import RESET_OPTIONS

from .conftest import EVERY

ROOT = Path(__file__).parents[2]
SMALL = {"n_boats": 9, "n_leaders": 2, "episode_s": 1.0}
ARGUMENTS = ("seed", "reset_mask", "render_mode", "render_size", "num_envs", "num_flocks")


def unwrapped(**options):
    inner = gymnasium.make("flockenv/Leaders-v0", **options)
    return gymnasium.wrappers.FlattenObservation(inner).unwrapped


@pytest.fixture(params=[*EVERY.values(), unwrapped], ids=[*EVERY, "unwrapped"])
def env(request):
    return request.param(**SMALL)


def test_names_of_options_are_no_attributes(env):
    """Also of such as the environment keeps under that name: parameters, modes and counts."""
    before = vars(env).copy()
    names = {*OPTIONS, *NAMES, *RESET_OPTIONS, *ARGUMENTS, "parameters", "num_leaders"}
    for name in sorted(names):
        for written in (name, name.upper(), name.title(), name.replace("_", "-")):
            with pytest.raises(AttributeError, match=f"^'{written}' cannot be set as an attribute"):
                setattr(env, written, 7)
    assert vars(env) == before


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("bw_s", r"(reset\(options=.*|set_options) sets 'bw_s'"),
        ("bw", r"(reset\(options=.*|set_options) sets 'bw_s'"),
        ("target", r"(reset\(options=.*|set_options) sets 'target'"),
        ("seed", "a reset"),
        ("n_boats", "make another one"),
        ("c4", "make another one"),
        ("render_mode", "make another one"),
    ],
)
def test_the_error_says_what_sets_it(env, name, words):
    with pytest.raises(AttributeError, match=words):
        setattr(env, name, 2.0)


def test_other_attributes_are_set_and_copies_are_made(env):
    env.note = 3
    env._bw_s = 4
    assert (env.note, vars(env)["_bw_s"]) == (3, 4)
    # PettingZoo's wrappers have no copies of their own.
    if hasattr(env, "clone"):
        assert env.clone().note == copy.deepcopy(env).note == 3


def test_gymnasium_sets_no_option_through_wrappers():
    """`set_wrapper_attr` would set on the outermost wrapper what the environment does not have."""
    inner = gymnasium.make("flockenv/Leaders-v0", **SMALL)
    env = gymnasium.wrappers.RecordEpisodeStatistics(gymnasium.wrappers.FlattenObservation(inner))
    for name in ("bw_s", "n_boats", "target", "parameters"):
        for each in (inner, env):
            with pytest.raises(AttributeError, match=f"'{name}' cannot be set as an attribute"):
                each.set_wrapper_attr(name, 2.0)
    many = gymnasium.vector.SyncVectorEnv([lambda: EVERY["gymnasium.make"](**SMALL)] * 2)
    with pytest.raises(AttributeError, match="'bw_s' cannot be set as an attribute"):
        many.set_attr("bw_s", 2.0)
    env.set_wrapper_attr("note", 3)
    assert env.get_wrapper_attr("note") == 3


def test_what_is_made_by_id_is_the_environment_itself():
    """A wrapper around it would take any attribute, and keep it to itself."""
    env = gymnasium.make("flockenv/Order-easy-v0")
    assert type(env) is flockenv.LeadersEnv
    with pytest.raises(flockenv.EpisodeError, match="reset"):
        env.step(np.zeros(4))
    again = gymnasium.make(pickle.loads(pickle.dumps(env.spec)))
    assert again.unwrapped.parameters == env.parameters


@pytest.mark.parametrize("make", EVERY.values(), ids=EVERY.keys())
def test_what_holds_for_the_next_episodes_is_set_by_a_method(make):
    env = make(**SMALL)
    bare = env if hasattr(env, "_batch") else env.unwrapped
    env.reset()
    bare.set_next_episodes(bw_s=0.6, target="ccw")
    env.reset()
    env.reset()
    episodes = [bare._batch.core.episode(flock) for flock in range(bare._batch.num_flocks)]
    assert {(each["bw_s"], each["target"]) for each in episodes} == {(0.6, "ccw")}
    bare.set_next_episodes(bw_s=np.array([0.1, 0.2]))
    env.reset()
    assert 0.1 < bare._batch.core.episode(0)["bw_s"] < 0.2
    before = bare._batch.core.to_bytes()
    for refused in ({"n_boats": 5}, {"bw_s": -1.0}, {"bw": 0.3}, {"target": "up"}):
        with pytest.raises(flockenv.ParameterError):
            bare.set_next_episodes(**refused)
    assert bare._batch.core.to_bytes() == before


def bw_s_after_some_episodes(venv) -> set[float]:
    venv.reset()
    for _ in range(12):
        venv.step(np.zeros((venv.num_envs, *venv.action_space.shape)))
    return {each["bw_s"] for each in venv.env_method("episode")}


def test_a_curriculum_reaches_flocks_in_stable_baselines3s_monitor():
    pytest.importorskip("stable_baselines3")
    from stable_baselines3.common.env_util import make_vec_env

    for venv in (
        make_vec_env("flockenv/Leaders-v0", 2, env_kwargs=SMALL),
        flockenv.sb3.LeaderVecEnv(2, **SMALL),
    ):
        venv.env_method("set_next_episodes", bw_s=0.6)
        assert bw_s_after_some_episodes(venv) == {0.6}


def test_set_attr_stays_with_stable_baselines3s_monitor_as_the_page_says():
    """An environment does not hear of it: what is set is an attribute of the wrapper around it."""
    pytest.importorskip("stable_baselines3")
    from stable_baselines3.common.env_util import make_vec_env

    venv = make_vec_env("flockenv/Leaders-v0", 2, env_kwargs={**SMALL, "bw_s": 0.3})
    venv.set_attr("bw_s", 0.6)
    assert bw_s_after_some_episodes(venv) == {0.3}
    # Without a wrapper around it, it is refused.
    bare = venv.envs[0].unwrapped
    with pytest.raises(AttributeError, match="set_next_episodes"):
        bare.bw_s = 0.6
    page = (ROOT / "docs" / "training_reference.md").read_text(encoding="utf-8")
    assert "`set_attr` would set an attribute of stable-baselines3's `Monitor`" in page


def test_no_recipe_sets_options_by_set_attr():
    """But on a `LeaderVecEnv`, whose own it is."""
    files = [
        each
        for folder, kinds in (("docs", ("*.md", "*.ipynb")), ("examples", ("*.py", "*.ipynb")))
        for kind in kinds
        for each in (ROOT / folder).rglob(kind)
        if "_build" not in each.parts
    ]
    calls = [
        line.strip()
        for each in [*files, ROOT / "README.md", *(ROOT / "baselines").glob("*.py")]
        for line in each.read_text(encoding="utf-8").splitlines()
        if re.search(r"\.set_attr\(", line)
    ]
    assert len(files) > 30
    assert calls == []
