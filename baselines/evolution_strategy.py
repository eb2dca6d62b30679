"""Search a leader policy with an evolution strategy, in NumPy.

    python baselines/evolution_strategy.py                         # an easy flock, two minutes
    python baselines/evolution_strategy.py --task wide --flock-hours 500 \\
        --sigma 0.3 --learning-rate 0.1 --out results/wide

With seeds 0 to 4, three leaders in `wide` reach an order of 0.412 to 0.467 after 500 flock-hours,
1.8 minutes of one core. The tuned law, from which they start, has 0.451 in the same flocks (results
version 5).

The policy is linear in what a leader observes. Each generation draws Gaussian perturbations of the
weights. Each perturbation gives two candidates: it is added in one and subtracted in the other.
Each candidate leads one flock. All flocks are one batch of the simulator and have the same seed, so
that candidates differ only by their weights. Their mean rewards are replaced by ranks, and Adam
follows the estimated gradient (Salimans et al. 2017). An interrupted command resumes from its last
generation. The result is a policy file: the law `policy.json` if leaders lean, and `policy.npz`
otherwise.

    flockenv compare --policy "paper's law" --policy results/wide/policy.json
"""

import argparse
import json
import shlex
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import flockenv
from flockenv.comparison import score_policies
from flockenv.policies import LeaningLaw, NetworkPolicy
from flockenv.policies.laws import LARGEST_LEAN, LEAN_FEATURES
from flockenv.policies.provenance import provenance_of
from flockenv.runs.seeds import POLICY_SEEDS

SEEDS = POLICY_SEEDS["evolution strategy"]
DECAY_1, DECAY_2 = 0.9, 0.99


def lean(pool: str, episode_s: float) -> dict[str, Any]:
    """Return the task of examples/train_leaders.py: three leaders lean about the tangent.

    A leader that does not lean follows the tuned law, so the search starts from this law. The
    only reward is the signed order.
    """
    switched_off = dict.fromkeys(("own", "phase", "target", "order"), False)
    return {
        "pool": pool,
        "n_boats": 27,
        "n_leaders": 3,
        "bw_s": flockenv.FlockParameters.critical_bw_s("simulation", pool),
        "observation": {**switched_off, "neighbors": 0, "lean_features": True},
        "action_mode": "lean",
        "decision_period_s": 1.0,
        "episode_s": episode_s,
        "physics": "training",
    }


TASKS: dict[str, dict[str, Any]] = {
    "easy": {
        "n_boats": 6,
        "n_leaders": 2,
        "bw_s": 0.1,
        "control_hz": 2.0,
        "episode_s": 60.0,
        "reward": {"leader_velocity": 1.0},
    },
    "wide": lean("wide", 480.0),
    "narrow": lean("narrow", 240.0),
}


def environment(task: str, flocks: int) -> flockenv.LeadersVectorEnv:
    """Return a vector environment with this number of flocks of a task."""
    options = {"target": "random", "mirror_to_target": True, **TASKS[task]}
    return flockenv.LeadersVectorEnv(flocks, autoreset_mode="disabled", **options)


def episode(env: flockenv.LeadersVectorEnv, seeds: list[int], steer: Any) -> tuple[Any, Any]:
    """Return the mean reward per decision and the signed order of one episode of each flock."""
    observations, _ = env.reset(seed=seeds)
    total, steps, ended = np.zeros(env.num_envs), 0, np.zeros(env.num_envs, bool)
    while not ended.all():
        observations, rewards, _, ended, infos = env.step(steer(observations))
        total, steps = total + rewards, steps + 1
    return total / steps, infos["episode_summary"]["signed_order"]


def linear(weights: np.ndarray, leaders: int) -> Any:
    """Return the function that steers each flock by its own linear map of observations.

    `weights` has shape (flocks, size + 1): the last number is the bias. The function takes
    observations of shape (flocks, leaders * size), and returns actions (flocks, leaders).
    """
    matrix, bias = weights[:, :-1].astype(np.float32), weights[:, -1:].astype(np.float32)

    def steer(observations: np.ndarray) -> np.ndarray:
        rows = observations.reshape(len(matrix), leaders, -1)
        return np.clip(np.einsum("fls,fs->fl", rows, matrix) + bias, -1.0, 1.0)

    return steer


def ranks(values: np.ndarray) -> np.ndarray:
    """Return the ranks of values, scaled from -0.5 for the worst to 0.5 for the best."""
    rank = np.empty(len(values))
    rank[np.argsort(values, kind="stable")] = np.arange(len(values))
    return rank / (len(values) - 1) - 0.5


def next_generation(
    state: dict[str, Any], env: Any, options: argparse.Namespace, steer: Any = None
) -> dict[str, Any]:
    """Try the candidates of a generation, and return the state of the search after it.

    `steer` maps weights and the number of leaders to a policy, as the default `linear` does.
    """
    weights, number = state["weights"], int(state["generation"])
    # Each generation seeds its own random generator, so a checkpoint stores only its number.
    random = np.random.default_rng([options.seed, number])
    changes = random.standard_normal((options.pairs, len(weights)))
    candidates = weights + options.sigma * np.concatenate([changes, -changes])
    seeds = list(SEEDS.seeds(1, options.seed, number)) * len(candidates)
    rewards, orders = episode(env, seeds, (steer or linear)(candidates, env.num_leaders))
    scores = ranks(rewards)
    gradient = (scores[: options.pairs] - scores[options.pairs :]) @ changes
    gradient /= 2 * options.pairs * options.sigma
    moment_1 = DECAY_1 * state["moment_1"] + (1 - DECAY_1) * gradient
    moment_2 = DECAY_2 * state["moment_2"] + (1 - DECAY_2) * gradient**2
    step = moment_1 / (1 - DECAY_1 ** (number + 1))
    step /= np.sqrt(moment_2 / (1 - DECAY_2 ** (number + 1))) + 1e-8
    weights = weights + options.learning_rate * step
    average = state["average"] + options.moving_average * (weights - state["average"])
    return {
        "generation": np.array(number + 1),
        "weights": weights,
        "average": average,
        "moment_1": moment_1,
        "moment_2": moment_2,
        "curve": np.append(state["curve"], [[rewards.mean(), orders.mean()]], axis=0),
    }


def first_state(size: int) -> dict[str, Any]:
    """Return the state before the first generation.

    With weights of zero, leaders go straight ahead or, if they lean, follow the tuned law.
    """
    zeros = {name: np.zeros(size) for name in ("weights", "average", "moment_1", "moment_2")}
    return {"generation": np.array(0), "curve": np.zeros((0, 2)), **zeros}


def stored_state(path: Path, identity: str) -> dict[str, Any] | None:
    """Return the state of an interrupted search, None without one; exit if options differ."""
    if not path.exists():
        return None
    with np.load(path) as file:
        arrays = dict(file)
    if str(arrays.pop("identity", "")) != identity:
        sys.exit(f"{path} is of a search with other options: name another folder with --out")
    return arrays


def search(options: argparse.Namespace, command: str) -> np.ndarray:
    """Search, write the policy and the learning curve, and return the average weights."""
    env, start_s = environment(options.task, 2 * options.pairs), time.process_time()
    size = env.single_observation_space.shape[0] // env.num_leaders
    # Options that may change when a search is resumed.
    may_change = ("out", "flock_hours", "episodes")
    identity = json.dumps({k: v for k, v in vars(options).items() if k not in may_change})
    path = options.out / "state.npz"
    state = stored_state(path, identity) or first_state(size + 1)
    options.out.mkdir(parents=True, exist_ok=True)
    hours = env.num_envs * TASKS[options.task]["episode_s"] / 3600.0
    while int(state["generation"]) * hours < options.flock_hours:
        state = next_generation(state, env, options)
        # Written beside the checkpoint and then renamed, so that an interrupt leaves it whole.
        partial = path.with_suffix(".half.npz")
        np.savez(partial, **state, identity=identity)
        partial.replace(path)
        reward, order = state["curve"][-1]
        done = int(state["generation"]) * hours
        print(f"{done:.2f} flock-hours: mean reward {reward:.3f}, signed order {order:.3f}")
    rows = [(number * hours + hours, *point) for number, point in enumerate(state["curve"])]
    header = "flock_hours,mean_reward,signed_order"
    np.savetxt(options.out / "curve.csv", rows, "%.5g", ",", header=header, comments="")
    generations, decisions_hz = int(state["generation"]), env.metadata["render_fps"]
    provenance = provenance_of(
        command,
        seed=options.seed,
        samples=round(generations * hours * 3600 * env.num_leaders * decisions_hz),
        cpu_s=time.process_time() - start_s,
        flock_hours=generations * hours,
    )
    save(options, env, state["average"], provenance)
    return np.asarray(state["average"])


def save(
    options: argparse.Namespace, env: Any, weights: np.ndarray, provenance: dict[str, str]
) -> None:
    """Write the policy: a law of leans if leaders lean, otherwise a network."""
    if TASKS[options.task].get("action_mode") == "lean":
        *leans, bias = map(float, LARGEST_LEAN * weights)
        weights_by_feature = dict(zip(LEAN_FEATURES, leans, strict=True))
        law = LeaningLaw(
            options.task, bias, weights_by_feature, bound="clip", provenance=provenance
        )
        law.save(options.out / "policy.json")
        return
    observation = env.single_observation_space.options["observation"]
    layout = {"observation": observation, "mirror_to_target": True, "provenance": provenance}
    NetworkPolicy([weights[:-1, None]], [weights[-1:]], **layout).save(options.out / "policy.npz")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--task", choices=TASKS, default="easy")
    parser.add_argument("--flock-hours", type=float, default=27.0)
    parser.add_argument("--pairs", type=int, default=64, help="pairs of opposite perturbations")
    parser.add_argument("--sigma", type=float, default=0.1, help="their standard deviation")
    parser.add_argument("--learning-rate", type=float, default=0.05, help="of Adam")
    parser.add_argument(
        "--moving-average", type=float, default=0.1, help="share of the newest weights"
    )
    parser.add_argument("--episodes", type=int, default=64, help="held-out episodes at the end")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/evolution"))
    options = parser.parse_args(arguments)
    if min(options.pairs, options.episodes) < 2:
        parser.error("--pairs and --episodes are at least 2")
    words = sys.argv[1:] if arguments is None else arguments
    weights = search(options, shlex.join(["python", "baselines/evolution_strategy.py", *words]))
    env, seeds = environment(options.task, options.episodes), list(range(options.episodes))
    orders = {}
    for name, candidate in (("evolved", weights), ("no search", 0.0 * weights)):
        steer = linear(np.tile(candidate, (options.episodes, 1)), env.num_leaders)
        _, orders[name] = episode(env, seeds, steer)
    print(score_policies(orders, "no search").round(3).to_string(index=False))
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
