"""Steps per second of other multi-agent environments: `python benches/peers.py vmas 5` prints JSON.

Runs in an environment of its own (`make throughput` sets it up): the peers pin other versions.
"""

import json
import sys
import time
from collections.abc import Callable

AGENTS = 27
ENVS = 64


def rate(step: Callable[[], None], steps_each: int, seconds: float) -> float:
    """Environment steps per second over at least so many seconds, after a warm-up."""
    for _ in range(5):
        step()
    done, start = 0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        step()
        done += steps_each
    return done / (time.perf_counter() - start)


def vmas_flocking(seconds: float) -> float:
    """VMAS `flocking`: 27 agents, 64 environments in one batch on the processor."""
    import torch
    import vmas

    env = vmas.make_env("flocking", num_envs=ENVS, device="cpu", seed=0, n_agents=AGENTS)
    env.reset()
    actions = [torch.rand(ENVS, env.get_agent_action_size(agent)) for agent in env.agents]
    return rate(lambda: env.step(actions), ENVS, seconds)


def mpe2_simple_spread(seconds: float) -> float:
    """MPE2 `simple_spread`: 27 agents, one environment (it has no batches)."""
    from mpe2 import simple_spread_v3

    env = simple_spread_v3.parallel_env(N=AGENTS, max_cycles=10_000_000)
    env.reset(seed=0)
    actions = dict.fromkeys(env.agents, 1)
    return rate(lambda: env.step(actions), 1, seconds)


PEERS = {"vmas": vmas_flocking, "mpe2": mpe2_simple_spread}

if __name__ == "__main__":
    name, seconds = sys.argv[1], float(sys.argv[2])
    print(json.dumps({"value": PEERS[name](seconds)}))
