"""Law: environments are made by their ids, with and without an import of the package."""

import subprocess
import sys

import gymnasium
import numpy as np
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
        "import gymnasium, flockenv",
        # To look for Gymnasium is not to import it.
        "import flockenv, importlib.util; importlib.util.find_spec('gymnasium'); import gymnasium",
    ],
)
def test_ids_are_known_whichever_is_imported_first(imports):
    code = f"{imports}; print(sorted(gymnasium.registry))"
    listed = subprocess.check_output([sys.executable, "-c", code], text=True)
    assert all(repr(env_id) in listed for env_id in ENVIRONMENTS)


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
