"""Every interface, and windows on SDL's dummy screen: conformance suites try every render mode."""

import os

import gymnasium
import numpy as np
import pytest

import flockenv

os.environ["SDL_VIDEODRIVER"] = "dummy"


def leader_vec_env(**options):
    pytest.importorskip("stable_baselines3")
    return flockenv.sb3.LeaderVecEnv(3, **options)


def torchrl_env(**options):
    pytest.importorskip("torchrl")
    return flockenv.torchrl.LeadersEnv(3, **options)


#: One flock or three, each with its own reset and state.
INTERFACES = {
    "single": flockenv.LeadersEnv,
    "parallel": flockenv.parallel_env,
    "vector": lambda **options: flockenv.LeadersVectorEnv(3, **options),
}
EVERY = {
    **INTERFACES,
    "aec": flockenv.env,
    "gymnasium.make": lambda **options: gymnasium.make("flockenv/Leaders-v0", **options),
    "gymnasium.make_vec": lambda **options: gymnasium.make_vec(
        "flockenv/Leaders-v0", num_envs=3, **options
    ),
    "sb3": leader_vec_env,
    "torchrl": torchrl_env,
}


def actions_for(env, action):
    """What `action(shape)` gives for one flock or many; by name where agents have names."""
    if isinstance(env, flockenv.LeadersParallelEnv):
        return {agent: action((1,)) for agent in env.possible_agents}
    return action(env.action_space.shape)


def zeros(env):
    return actions_for(env, np.zeros)
