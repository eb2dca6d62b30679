"""Use your own reward: `python examples/own_reward.py FLOCKS SECONDS`.

The reward may be any function of the vector environment after its step. Here it is the fraction of
normal boats that are away from the outer wall.
"""

import sys

import gymnasium
import numpy as np

import flockenv
from flockenv.statistics import mean_interval

# Arguments that are left out are 8 and 60.
flocks, seconds = map(int, sys.argv[1:] + ["8", "60"][len(sys.argv) - 1 :])


def away_from_the_wall(envs):
    """Return each flock's fraction of normal boats that are more than 30 cm from the outer wall."""
    normal = envs.poses()[:, 3:]  # boats 0 to 2 are the leaders
    radius_cm = np.hypot(normal[..., 0], normal[..., 1])
    return (radius_cm < 180.0 - 30.0).mean(axis=1)


envs = gymnasium.make_vec(
    "flockenv:flockenv/Leaders-v0", num_envs=flocks, n_boats=27, n_leaders=3, pool="wide",
    bw_s=0.31, episode_s=float(seconds), reward=away_from_the_wall,
)  # fmt: skip
for policy in (flockenv.policies.SteeringLaw(), flockenv.policies.StraightAhead()):
    observation, info = envs.reset(seed=0)
    total = np.zeros(flocks)
    for _ in range(10 * seconds):  # ten decisions per second
        action, _ = policy.predict(observation)
        observation, reward, terminated, truncated, info = envs.step(action)
        total += reward
    mean, low, high = mean_interval(total / (10 * seconds))
    name = type(policy).__name__
    print(f"{name}: {mean:.3f} [{low:.3f}, {high:.3f}], 95 % interval of {flocks} flocks")
envs.close()
