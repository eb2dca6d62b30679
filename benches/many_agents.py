"""Environment steps of 27 agents per second of processor time, on one thread, here and elsewhere.

`python benches/many_agents.py flocking 1024` by an interpreter that has the library of this name:

    flockenv                 this package, random rudders of 4 leaders, one control step of 0.1 s
    flocking, dropout        tasks of VMAS 1.5.2 (pip install vmas), random actions
    simple_spread            of MPE in JaxMARL 0.2.0 (pip install jaxmarl), compiled
    boids                    of PufferLib 3.0.0, in C: benches/peers/boids.c says how

Processor time and one thread, so that numbers of a busy machine can be compared.
"""

import os
import sys
import time
from collections.abc import Callable

AGENTS = 27
SECONDS = 3.0


def rate(step: Callable[[], object], steps_each: int) -> float:
    """Return environment steps per second of processor time, after one step of warm-up."""
    step()
    done, start = 0, time.process_time()
    while (taken := time.process_time() - start) < SECONDS:
        step()
        done += steps_each
    return done / taken


def flockenv(envs: int) -> float:
    os.environ["RAYON_NUM_THREADS"] = "1"
    import gymnasium
    import numpy as np

    import flockenv as _  # noqa: F401 - its environments

    env = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=envs, n_boats=AGENTS, n_leaders=4)
    env.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (envs, 4))
    return rate(lambda: env.step(actions), envs)


def vmas(task: str, envs: int) -> float:
    import torch
    import vmas

    torch.set_num_threads(1)
    env = vmas.make_env(task, num_envs=envs, device="cpu", seed=0, n_agents=AGENTS)
    env.reset()
    sizes = [env.get_agent_action_size(agent) for agent in env.agents]
    actions = [2.0 * torch.rand(envs, size) - 1.0 for size in sizes]
    return rate(lambda: env.step(actions), envs)


def jaxmarl(envs: int) -> float:
    os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
    os.environ["JAX_PLATFORMS"] = "cpu"
    import jax
    from jaxmarl.environments.mpe.simple_spread import SimpleSpreadMPE

    env = SimpleSpreadMPE(num_agents=AGENTS, num_landmarks=AGENTS)
    actions = {agent: jax.numpy.ones(envs, int) for agent in env.agents}

    @jax.jit
    def step(state, key):
        observations, state, rewards, *_ = jax.vmap(env.step)(
            jax.random.split(key, envs), state, actions
        )
        return state, observations, rewards

    key = jax.random.PRNGKey(0)
    states = [jax.vmap(env.reset)(jax.random.split(key, envs))[1]]

    def advance() -> None:
        states[0], *outputs = step(states[0], key)
        jax.block_until_ready(outputs)

    return rate(advance, envs)


if __name__ == "__main__":
    name, number = sys.argv[1], int(sys.argv[2])
    measures = {"flockenv": flockenv, "simple_spread": jaxmarl}
    speed = measures[name](number) if name in measures else vmas(name, number)
    print(f"{name}, {number} environments: {speed:.0f} steps per second of one core")
