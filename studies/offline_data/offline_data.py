"""Make offline data sets of leaders in Minari's format: pip install "minari[hdf5]".

    python -m studies.offline_data.offline_data                    # 500 flock-hours of each policy
    python -m studies.offline_data.offline_data --flock-hours 5 --policy tuned

500 flock-hours have 4.5 million steps and 2.3 GB. All policies lead the flocks of the same seeds,
the first ones of "offline data" (flockenv/runs/seeds.py).

Four data sets, `flockenv/wide/paper-v0`, `tuned-v0`, `random-v0` and `learned-v0`, hold episodes of
8 minutes of 27 boats with three leaders in `wide` at its critical noise. The leaders follow the
paper's law, the tuned law, nothing (random rudders) and what was learned. A step is a decision of
all leaders, every 0.4 s. Its observation has the own state and the lean features of each leader,
one leader after the other, mirrored to the target; its action is their rudders, its reward the
signed order. `MINARI_DATASETS_PATH` says where files go.

    import minari
    for episode in minari.load_dataset("flockenv/wide/tuned-v0").iterate_episodes():
        episode.observations, episode.actions, episode.rewards, episode.truncations

Episodes are simulated by the package's results version, which each data set names; `checked` reads
one, and refuses a set of another version.
"""

import argparse
import shlex
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import minari
import numpy as np
from minari.data_collector import EpisodeBuffer

from flockenv import FlockParameters, LeadersVectorEnv, ParameterError
from flockenv.policies import DampedLaw, LeaningLaw, RandomRudders, SteeringLaw
from flockenv.policies.provenance import commit, provenance_of
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.runs.store import RESULTS_VERSION

POOL, BLOCK = "wide", 64
LEARNED = LeaningLaw.learned(POOL)
LAYOUT: dict[str, Any] = {"observation": LEARNED.observation, "mirror_to_target": True}
POLICIES: dict[str, Any] = {
    "paper": SteeringLaw(**LAYOUT),
    "tuned": DampedLaw.tuned(POOL, **LAYOUT),
    "random": RandomRudders(seed=0, **LAYOUT),
    "learned": LEARNED,
}


def options_of(episode_s: float) -> dict[str, Any]:
    """Return the options of the environment."""
    return {
        "n_boats": 27,
        "n_leaders": 3,
        "pool": POOL,
        "bw_s": FlockParameters.critical_bw_s("simulation", POOL),
        "target": "random",
        "control_hz": 2.5,
        "episode_s": episode_s,
        **LAYOUT,
    }


def episodes(policy: Any, seeds: range, episode_s: float) -> list[EpisodeBuffer]:
    """Return one episode a seed."""
    env = LeadersVectorEnv(len(seeds), autoreset_mode="disabled", **options_of(episode_s))
    seen, _ = env.reset(seed=list(seeds))
    observations, actions, rewards, ended = [seen], [], [], np.zeros(len(seeds), bool)
    state = None
    while not ended.all():
        rudders, state = policy.predict(seen, state)
        seen, reward, _, ended, _ = env.step(rudders)
        observations.append(seen)
        actions.append(np.asarray(rudders, np.float32))
        rewards.append(reward)
    table, rudders = np.array(observations), np.array(actions)
    steps = len(rewards)
    return [
        EpisodeBuffer(
            seed=seed,
            observations=table[:, flock],
            actions=rudders[:, flock],
            rewards=[float(each[flock]) for each in rewards],
            terminations=[False] * steps,
            truncations=[False] * (steps - 1) + [True],
        )
        for flock, seed in enumerate(seeds)
    ]


def make(name: str, flock_hours: float, episode_s: float, command: str) -> minari.MinariDataset:
    """Write the data set of a policy, block after block of flocks."""
    start, count = time.process_time(), max(1, round(flock_hours * 3600.0 / episode_s))
    dataset = None
    for first in range(0, count, BLOCK):
        seeds = POLICY_SEEDS["offline data"].seeds(min(BLOCK, count - first), start=first)
        found = episodes(POLICIES[name], seeds, episode_s)
        if dataset is None:
            env = gymnasium.make("flockenv/Leaders-v0", **options_of(episode_s))
            with warnings.catch_warnings():
                # Nobody's address stands in a file that anybody makes.
                warnings.filterwarnings("ignore", "`author_email` is set to None")
                dataset = minari.create_dataset_from_buffers(
                    f"flockenv/{POOL}/{name}-v0",
                    found,
                    env=env,
                    eval_env=env,
                    algorithm_name=name,
                    author="flockenv",
                    code_permalink=f"studies/offline_data/offline_data.py of commit {commit()}",
                    description="Leaders of a robotic flock of 27 boats",
                )
        else:
            dataset.update_dataset_from_buffer(found)
    assert dataset is not None
    made = provenance_of(
        command,
        seed=0,
        samples=3 * dataset.total_steps,
        cpu_s=time.process_time() - start,
        flock_hours=count * episode_s / 3600.0,
    )
    dataset.storage.update_metadata({"results_version": RESULTS_VERSION, **made})
    return dataset


def checked(dataset_id: str) -> minari.MinariDataset:
    """Return a data set of this results version: its flocks move as flocks do now.

    A ParameterError refuses others.
    """
    dataset = minari.load_dataset(dataset_id)
    version = dataset.storage.metadata.get("results_version")
    if version != RESULTS_VERSION:
        raise ParameterError(
            f"{dataset_id} has results version {version}, this flockenv has {RESULTS_VERSION}: "
            "make it again with studies/offline_data/offline_data.py"
        )
    return dataset


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--policy", choices=POLICIES, action="append", help="[all four]")
    parser.add_argument("--flock-hours", type=float, default=500.0, help="of each policy")
    parser.add_argument("--minutes", type=float, default=8.0, help="length of an episode")
    options = parser.parse_args(arguments)
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "-m", "studies.offline_data.offline_data", *given])
    for name in options.policy or POLICIES:
        dataset = make(name, options.flock_hours, options.minutes * 60.0, command)
        size = sum(each.stat().st_size for each in Path(dataset.storage.data_path).glob("*"))
        print(f"{dataset.spec.dataset_id}: {dataset.total_steps} steps, {size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
