"""Search three leaders from nothing: rudders, and no law in the action, the start or the reward.

    for seed in 2 3 4; do python -m studies.from_nothing.search_from_nothing narrow $seed; done

Seeds 2 to 4 reach an order of 0.244 to 0.255 in `narrow`, 16 minutes of one core each, where the
damped law has 0.238 and the tuned law 0.270.

A rudder, chosen ten times per second, is linear in the 29 lean features, which know no law, and a
constant. A boat that backs up has weights of its own, as a rudder works in reverse there. The
length of the 60 weights is fixed, and CMA-ES (Hansen's covariance matrix adaptation, from the
package cmaes) searches their direction, at first in all directions alike. A candidate steers one
flock from rest for a minute, and its score is the weighted mean of `contact_push`,
`contact_alignment` and `leader_velocity`. All candidates of a generation start in the same state.
Scores of chaotic flocks are so noisy that the mean of the candidates never settles. The result is
its average over the second half of the search: a network of four hidden units that every command
takes.

The learning curve and its end are those of train_from_nothing.py. Needs the extras search and sb3.

The design was fixed before these searches: seeds 2 to 4. Eight searches with seeds 1 and 10, of 170
to 1200 flock-hours each and 5000 together, chose the length of the weights, the minute from rest,
the candidates, the average and ten decisions per second, in `narrow`.
"""

import shlex
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from cmaes import CMA

from baselines.evolution_strategy import SEEDS, episode
from flockenv import LeadersVectorEnv
from flockenv.envs.observation import observation_entries
from flockenv.policies import NetworkPolicy
from flockenv.policies.laws import LEAN_FEATURES
from flockenv.policies.provenance import provenance_of
from flockenv.runs.seeds import release_seeds
from studies.from_nothing.train_from_nothing import JUDGES, LEADERS, OFF, flock, judged, write

CANDIDATES, EPISODE_S, SIGMA = 128, 60.0, 0.5
GENERATIONS, JUDGED_EVERY = 960, 120
#: Length of a candidate's weights: most rudders are hard over, and the network keeps its precision.
LENGTH = 20.0
REWARD = {"contact_push": 1.0, "leader_velocity": 5.0, "contact_alignment": 20.0}
OBSERVATION = {**OFF, "own": True, "lean_features": True}
NAMES = [entry.name for entry in observation_entries(OBSERVATION)]
#: A boat backs up where this is negative.
FORWARD = NAMES.index("forward_velocity")
OWN = len(NAMES) - len(LEAN_FEATURES)
#: How steeply the units of the network switch where a boat reverses.
GATE = 10_000.0


def steering(candidates: np.ndarray) -> Any:
    """Return what maps what leaders see (flocks, leaders * size) to rudders."""
    weights = candidates.astype(np.float32).reshape(len(candidates), 2, -1)

    def steer(seen: np.ndarray) -> np.ndarray:
        rows = seen.reshape(len(weights), LEADERS, -1)
        both = rows[:, :, OWN:] @ weights[:, :, :-1].swapaxes(1, 2) + weights[:, None, :, -1]
        return np.clip(np.where(rows[:, :, FORWARD] < 0.0, both[:, :, 1], both[:, :, 0]), -1, 1)

    return steer


def network(weights: np.ndarray, provenance: dict[str, str]) -> NetworkPolicy:
    """Return the same as a network: each direction is the difference of two units that switch.

    Below a hundredth of a boat's speed they have not switched, and rudders are between the two.
    """
    hidden, biases = np.zeros((len(NAMES), 4)), np.zeros(4)
    for unit, own in zip((0, 2), weights.reshape(2, -1), strict=True):
        hidden[FORWARD, unit : unit + 2] = GATE * (1 - unit)
        hidden[OWN:, unit], biases[unit] = own[:-1], own[-1]
    return NetworkPolicy(
        [hidden, np.array([[1.0], [-1.0], [1.0], [-1.0]])],
        [biases, np.zeros(1)],
        "relu",
        observation=OBSERVATION,
        mirror_to_target=True,
        provenance=provenance,
    )


def of_length(directions: np.ndarray) -> np.ndarray:
    """Return weights of the length that all candidates have."""
    return LENGTH * directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def search(pool: str, seed: int, folder: Path) -> None:
    """Search, and write the learning curve and the network."""
    folder.mkdir(parents=True, exist_ok=True)
    env = LeadersVectorEnv(
        CANDIDATES,
        autoreset_mode="disabled",
        n_leaders=LEADERS,
        observation=OBSERVATION,
        target="random",
        mirror_to_target=True,
        reward=REWARD,
        episode_s=EPISODE_S,
        physics="training",
        **flock(pool),
    )
    cma = CMA(np.zeros(2 * len(LEAN_FEATURES) + 2), SIGMA, seed=seed, population_size=CANDIDATES)
    means: list[np.ndarray] = []
    rows: list[dict[str, Any]] = []
    cpu_s = 0.0
    for generation in range(1, GENERATIONS + 1):
        start = time.process_time()
        candidates = [cma.ask() for _ in range(CANDIDATES)]
        seeds = list(SEEDS.seeds(1, seed, generation)) * CANDIDATES
        rewards, _ = episode(env, seeds, steering(of_length(np.array(candidates))))
        cma.tell(list(zip(candidates, -rewards, strict=True)))
        means.append(of_length(cma.mean))
        cpu_s += time.process_time() - start
        if generation % JUDGED_EVERY:
            continue
        hours = generation * CANDIDATES * EPISODE_S / 3600.0
        samples = round(hours * 3600 * LEADERS * env.metadata["render_fps"])
        command = shlex.join(
            ["python", "-m", "studies.from_nothing.search_from_nothing", pool, str(seed)]
        )
        made = provenance_of(command, seed=seed, samples=samples, cpu_s=cpu_s, flock_hours=hours)
        found = network(of_length(np.mean(means[len(means) // 2 :], axis=0)), made)
        found.save(folder / "policy.npz")
        point = {"stage": 1, "flock_hours": hours, "cpu_s": cpu_s}
        validation = release_seeds("from_nothing validation", JUDGES[0])
        rows += judged(pool, {"CMA-ES": found}, validation, point)
        print(rows[-1], flush=True)
    write(pool, {"CMA-ES": found}, rows, folder)


if __name__ == "__main__":
    search(sys.argv[1], int(sys.argv[2]), Path("results/from_nothing", "_".join(sys.argv[1:3])))
