"""Law: environments are made by their ids, of Gymnasium and of PettingZoo."""

import subprocess
import sys

import gymnasium
import numpy as np
import pettingzoo
import pytest

import flockenv
from flockenv.envs.ids import ENVIRONMENTS
from flockenv.policies import DampedLaw, RandomRudders

EASY_ID = "flockenv/Order-easy-v0"


@pytest.mark.parametrize("env_id", ENVIRONMENTS)
def test_ids_bring_their_options(env_id):
    env = gymnasium.make(env_id).unwrapped
    own = flockenv.LeadersEnv(**gymnasium.spec(env_id).kwargs)
    assert env.parameters == own.parameters
    assert env._batch.settings == own._batch.settings
    assert gymnasium.make_vec(env_id, num_envs=2).num_envs == 2
    assert gymnasium.make(env_id, n_boats=5).unwrapped.parameters.n_boats == 5


@pytest.mark.parametrize("env_id", ENVIRONMENTS)
def test_ids_import_the_package(env_id):
    code = f"import gymnasium; print(gymnasium.make('flockenv:{env_id}').reset(seed=0)[0].shape)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("(")


@pytest.mark.parametrize(
    "imports",
    [
        "import flockenv, gymnasium",
        "import gymnasium, flockenv; gymnasium.register_envs(flockenv)",
        "import gymnasium, flockenv, importlib; importlib.reload(flockenv)",
    ],
)
def test_ids_are_known_whichever_is_imported_first(imports):
    code = f"import sys; finders = [*sys.meta_path]; {imports}; print(sorted(gymnasium.registry))"
    code = f"{code}; assert sys.meta_path == finders"
    listed = subprocess.check_output([sys.executable, "-W", "error", "-c", code], text=True)
    assert all(repr(env_id) in listed for env_id in ENVIRONMENTS)


@pytest.mark.parametrize(
    ("words", "are_known"),
    [
        ([], True),
        (["flockenv", "--version"], False),
        (["flockenv", "presets"], True),
        (["flockenv", "run", "--help"], True),
        (["train.py", "--help"], True),
        (["flockenv.py"], True),
    ],
)
def test_only_the_command_line_that_prints_its_help_knows_no_ids(words, are_known):
    code = f"import sys; sys.argv = {words}; import flockenv, gymnasium; print(*gymnasium.registry)"
    listed = subprocess.check_output([sys.executable, "-c", code], text=True).split()
    assert {env_id in listed for env_id in ENVIRONMENTS} == {are_known}


@pytest.mark.skipif(not hasattr(pettingzoo, "register"), reason="PettingZoo has no ids")
@pytest.mark.parametrize("env_id", ENVIRONMENTS)
def test_pettingzoo_makes_the_same_environments(env_id):
    single = gymnasium.make(env_id)
    single.reset(seed=3)
    parallel = pettingzoo.make("parallel", env_id)
    assert isinstance(parallel, flockenv.LeadersParallelEnv)
    in_turn = pettingzoo.make("aec", env_id)
    for env in (parallel, in_turn):
        env.reset(seed=3)
        assert env.unwrapped.parameters == single.parameters
        assert env.unwrapped._batch.settings == single._batch.settings
        np.testing.assert_array_equal(env.unwrapped.flock.pose, single.flock.pose)
        env.unwrapped.step(
            {agent: env.action_space(agent).sample() for agent in env.possible_agents}
        )
    few = pettingzoo.make("parallel", env_id, n_boats=5)
    assert few.parameters == single.parameters.replace(n_boats=5)


def test_the_easy_environment_tells_good_leaders_from_bad():
    def mean_reward(policy):
        venv = gymnasium.make_vec(EASY_ID, num_envs=32, autoreset_mode="disabled")
        observations, _ = venv.reset(seed=0)
        total, over = np.zeros(32), np.zeros(32, bool)
        while not over.any():
            observations, rewards, _, over, _ = venv.step(policy.predict(observations)[0])
            total += rewards / 300
        return total.mean()

    options = ENVIRONMENTS[EASY_ID].options
    layout = {name: options[name] for name in ("observation", "mirror_to_target")}
    assert mean_reward(DampedLaw(**layout)) > mean_reward(RandomRudders(**layout)) + 0.1


@pytest.mark.parametrize(
    ("options", "steps"),
    [
        ({}, 4800),
        ({"target": "alternate"}, 9600),
        ({"episode_s": 10.0, "control_hz": 5.0}, 50),
        ({"episode_s": 1.0, "decision_period_s": 0.3}, 4),
    ],
)
def test_the_spec_says_how_many_steps_an_episode_has(options, steps):
    env = gymnasium.make("flockenv/Leaders-v0", **options)
    many = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=2, **options)
    for made in (env, env.unwrapped, many):
        assert made.spec.max_episode_steps == steps
    assert gymnasium.spec("flockenv/Leaders-v0").max_episode_steps is None
    assert gymnasium.make("flockenv/Leaders-v0", max_episode_steps=3).spec.max_episode_steps == 3
    assert flockenv.LeadersEnv(**options).spec is None
    env.reset(seed=0)
    if steps < 100:
        ends = [env.step(env.action_space.sample())[3] for _ in range(steps)]
        assert ends == [False] * (steps - 1) + [True]
