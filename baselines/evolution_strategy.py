"""Train a leader policy with an evolution strategy, with NumPy and flockenv alone.

    python baselines/evolution_strategy.py                          # an easy flock, two minutes
    python baselines/evolution_strategy.py --pool table-1 --boats 27 --leaders 3 --noise 1 \
        --control-hz 10 --episode-s 120 --reward signed_order --generations 300 \
        --out results/evolution/table-1

Gaussian perturbations of all weights are tried in antithetic pairs, with one or several flocks for
each, all in one batch of the simulator. Candidates of a generation steer the same episodes, so that
they differ by their weights alone. Their mean rewards are replaced by ranks, and Adam follows the
estimated gradient. The policy is linear feedback on the observation unless hidden layers are given;
with --form leaning it is a `LeaningLaw`, which starts as the damped law. An interrupted command
resumes from the last generation. The result is a policy file:

    flockenv compare --policy "steering law" --policy results/evolution/policy.npz
"""

import argparse
import json
import shlex
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from policy_forms import NAMES, LeaningShape, Shape
from rich.progress import Progress
from run_number import run_number
from script_end import one_line_end

import flockenv
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv._io.provenance import provenance_of
from flockenv.cli.parameters import changed_fields
from flockenv.envs.observation import OBSERVATION_VERSION
from flockenv.envs.reward import TERMS
from flockenv.policies import DampedLaw, LeaningLaw, NetworkPolicy
from flockenv.policies.pretrained import TUNED_GAINS
from flockenv.runs.executors import cores, named
from flockenv.runs.seeds import POLICY_SEEDS

SEEDS = POLICY_SEEDS["evolution strategy"]
DECAY_1, DECAY_2 = 0.9, 0.99
ROUGH_GAINS = {"gain": 1.9, "backward_gain": 3.0, "damping": 20.0}
LIBERAL_STEPS = {"dt_s": 0.1, "relinearizations": 1}


@dataclass
class State:
    """Where the search is: all that the next generation depends on."""

    generation: int
    weights: np.ndarray
    moment_1: np.ndarray
    moment_2: np.ndarray
    average: np.ndarray
    wall_s: float
    curve: np.ndarray


def flock_parameters(options: argparse.Namespace, leaders: int) -> flockenv.FlockParameters:
    """Where a generation steers; --set takes what no other option rules."""
    critical = flockenv.FlockParameters.critical_bw_s("simulation", options.pool)
    ruled = {
        "pool": ("--pool", options.pool),
        "n_boats": ("--boats", options.boats),
        "n_leaders": ("--leaders", leaders),
        "bw_s": ("--noise", options.noise * critical),
        # Mirrored, both directions are this one.
        "target": ("the search itself", "cw"),
    }
    if options.liberal_steps:
        ruled |= {name: ("--liberal-steps", value) for name, value in LIBERAL_STEPS.items()}
    changes = changed_fields(options.set)
    for name in changes:
        if name in ruled:
            ruler = ruled[name][0]
            raise flockenv.ParameterError(f"--set {name} is not accepted: {ruler} rules it")
    fields = {name: value for name, (_, value) in ruled.items()} | changes
    try:
        return flockenv.FlockParameters.preset("simulation").replace(**fields)
    except TypeError as error:
        raise flockenv.ParameterError(f"--set: {error}") from error


def leaning_shape(options: argparse.Namespace) -> LeaningShape:
    """The form of a leaning law, measured in the flock of the search."""
    gains = TUNED_GAINS["damped law"][options.pool] if options.tuned else ROUGH_GAINS
    seeds = list(SEEDS.seeds(16, options.seed))
    env = environment(options, len(seeds), options.leaders[0])
    steps = round(min(60.0, options.episode_s) * options.control_hz)
    return LeaningShape(DampedLaw(**gains, mirror_to_target=True), env, seeds, steps)


def environment(
    options: argparse.Namespace, flocks: int, leaders: int
) -> flockenv.LeadersVectorEnv:
    return flockenv.LeadersVectorEnv(
        flocks,
        autoreset_mode="disabled",
        params=flock_parameters(options, leaders),
        target="random",
        mirror_to_target=True,
        control_hz=options.control_hz,
        episode_s=options.episode_s,
        reward={options.reward: 1.0},
    )


def mean_rewards(
    env: flockenv.LeadersVectorEnv,
    seeds: list[int],
    steer: Callable[[np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Mean reward and mean signed order of one episode a flock."""
    observations, _ = env.reset(seed=seeds)
    total, steps, ended = np.zeros(env.num_envs), 0, np.zeros(env.num_envs, bool)
    while not ended.all():
        observations, rewards, _, ended, infos = env.step(steer(observations))
        total += rewards
        steps += 1
    return total / steps, infos["episode_summary"]["signed_order"]


def scores(
    env: flockenv.LeadersVectorEnv,
    shape: Shape | LeaningShape,
    candidates: np.ndarray,
    seeds: list[int],
) -> np.ndarray:
    """Mean reward of each candidate; all of them steer the episodes of the same seeds."""
    count, rudders = len(candidates), shape.steering(candidates)

    def steer(observations: np.ndarray) -> np.ndarray:
        rows = observations.reshape(count, len(seeds) * env.num_leaders, -1)
        return rudders(rows).reshape(env.num_envs, env.num_leaders)

    rewards, _ = mean_rewards(env, seeds * count, steer)
    return rewards.reshape(count, len(seeds)).mean(axis=1)


@dataclass(frozen=True)
class Part:
    """Some candidates of a generation: all that a worker needs to score them."""

    options: argparse.Namespace
    leaders: int
    shape: Shape | LeaningShape
    candidates: np.ndarray
    seeds: list[int]


def part_scores(part: Part) -> np.ndarray:
    """Return the scores of some candidates, in any thread or process."""
    flocks = len(part.candidates) * len(part.seeds)
    env = environment(part.options, flocks, part.leaders)
    return scores(env, part.shape, part.candidates, part.seeds)


def scores_on_engine(
    options: argparse.Namespace,
    leaders: int,
    shape: Shape | LeaningShape,
    candidates: np.ndarray,
    seeds: list[int],
) -> np.ndarray:
    """Return the scores of all candidates, computed in parts where `--engine` says."""
    workers = options.workers or cores()
    shares = np.array_split(candidates, min(len(candidates), workers))
    parts = [Part(options, leaders, shape, share, seeds) for share in shares]
    found = dict(named(options.engine)(part_scores, parts, workers))
    return np.concatenate([found[place] for place in range(len(parts))])


def centered_ranks(values: np.ndarray) -> np.ndarray:
    """From -0.5 for the worst to 0.5 for the best."""
    ranks = np.empty(len(values))
    ranks[np.argsort(values, kind="stable")] = np.arange(len(values))
    return ranks / (len(values) - 1) - 0.5


def next_generation(
    state: State,
    env: flockenv.LeadersVectorEnv,
    shape: Shape | LeaningShape,
    options: argparse.Namespace,
) -> State:
    # A generator of its own for each generation: nothing but the number has to be remembered.
    number = state.generation
    random = np.random.default_rng([options.seed, number])
    half = random.standard_normal((options.pairs, shape.size))
    candidates = state.weights + options.sigma * np.concatenate([half, -half])
    seeds = list(SEEDS.seeds(options.flocks, options.seed, number * options.flocks))
    if options.engine is None:
        found = scores(env, shape, candidates, seeds)
    else:
        found = scores_on_engine(options, env.num_leaders, shape, candidates, seeds)
    ranks = centered_ranks(found)
    gradient = (ranks[: options.pairs] - ranks[options.pairs :]) @ half
    gradient /= 2 * options.pairs * options.sigma
    moment_1 = DECAY_1 * state.moment_1 + (1 - DECAY_1) * gradient
    moment_2 = DECAY_2 * state.moment_2 + (1 - DECAY_2) * gradient**2
    direction = (moment_1 / (1 - DECAY_1 ** (number + 1))) / (
        np.sqrt(moment_2 / (1 - DECAY_2 ** (number + 1))) + 1e-8
    )
    weights = state.weights + options.rate * direction
    average = state.average + options.average * (weights - state.average)
    curve = np.append(state.curve, found.mean())
    return State(number + 1, weights, moment_1, moment_2, average, state.wall_s, curve)


def identity(reported: dict[str, Any]) -> dict[str, Any]:
    """Return the options that a stored search must share to be resumed."""
    free = ("out", "generations", "quiet", "episodes", "engine", "workers")
    whole = {
        "observation_version": OBSERVATION_VERSION,
        "first_seed": SEEDS.first,
        **reported,
    }
    return {name: value for name, value in whole.items() if name not in free}


def load_state(path: Path, options: argparse.Namespace) -> State | None:
    if not path.exists():
        return None
    arrays = read_arrays(path)
    try:
        stored = identity(json.loads(str(arrays["identity"])))
    except (KeyError, TypeError, ValueError) as error:
        raise flockenv.ParameterError(f"{path} is no state of a search") from error
    if stored != identity(vars(options)):
        raise flockenv.ParameterError(
            f"{path} is of a search with other options: name another folder with --out"
        )
    numbers = [arrays[name] for name in ("weights", "moment_1", "moment_2", "average")]
    wall_s, curve = float(arrays["wall_s"]), arrays["curve"]
    return State(int(arrays["generation"]), *numbers, wall_s, curve)


def save_state(path: Path, state: State, options: argparse.Namespace) -> None:
    arrays: dict[str, Any] = {name: np.asarray(value) for name, value in vars(state).items()}
    write_arrays(path, {**arrays, "identity": np.array(json.dumps(identity(vars(options))))})


def samples_of(options: argparse.Namespace, generations: int) -> int:
    steps = round(options.episode_s * options.control_hz)
    leaders = sum(leaders_of(options, generation) for generation in range(generations))
    return 2 * options.pairs * options.flocks * leaders * steps


def leaders_of(options: argparse.Namespace, generation: int) -> int:
    return options.leaders[generation % len(options.leaders)]


def search(options: argparse.Namespace, command: str) -> NetworkPolicy | LeaningLaw:
    flocks = 2 * options.pairs * options.flocks
    envs = {leaders: environment(options, flocks, leaders) for leaders in set(options.leaders)}
    leaning = options.form == "leaning"
    shape = leaning_shape(options) if leaning else Shape(len(NAMES), options.hidden)
    path = options.out / "state.npz"
    options.out.mkdir(parents=True, exist_ok=True)
    state = load_state(path, options)
    if state is None:
        weights = shape.first(np.random.default_rng(options.seed))
        state = State(0, weights, 0 * weights, 0 * weights, weights, 0.0, np.empty(0))
    start = time.perf_counter() - state.wall_s
    with Progress(disable=options.quiet) as progress:
        task = progress.add_task("", total=options.generations, completed=state.generation)
        while state.generation < options.generations:
            env = envs[leaders_of(options, state.generation)]
            state = next_generation(state, env, shape, options)
            state.wall_s = time.perf_counter() - start
            save_state(path, state, options)
            words = f"mean reward of the candidates {state.curve[-1]:.3f}"
            progress.update(task, description=words, completed=state.generation)
    samples = samples_of(options, state.generation)
    provenance = provenance_of(command, seed=options.seed, samples=samples, wall_s=state.wall_s)
    policy = shape.policy(state.average, provenance)
    policy.save(options.out / "policy.npz")
    return policy


def print_held_out(options: argparse.Namespace, policies: dict[str, Any]) -> None:
    """Print the rewards of policies in episodes that the search has not used."""
    env = environment(options, options.episodes, options.leaders[0])
    for label, policy in policies.items():
        steer = lambda rows, policy=policy: policy.predict(rows)[0]  # noqa: E731
        found = mean_rewards(env, list(POLICY_SEEDS["evaluation"].seeds(options.episodes)), steer)
        for name, values in zip((options.reward, "signed order"), found, strict=True):
            half = 1.96 * values.std(ddof=1) / np.sqrt(options.episodes)
            print(f"{label}: mean {name} {values.mean():.3f} ± {half:.3f}")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=("500-boats", "table-1"), default="500-boats")
    parser.add_argument("--boats", type=int, default=6, help="leaders included")
    parser.add_argument(
        "--leaders", type=int, nargs="+", default=[2], help="of the generations in turn"
    )
    parser.add_argument("--noise", type=float, default=0.3, help="1: the pool's critical noise")
    parser.add_argument("--control-hz", type=float, default=2.0)
    parser.add_argument("--episode-s", type=float, default=60.0)
    parser.add_argument("--liberal-steps", action="store_true", help="dt_s 0.1, one pass")
    parser.add_argument(
        "--set", action="append", default=[], metavar="FIELD=VALUE", help="of FlockParameters"
    )
    parser.add_argument("--form", choices=("network", "leaning"), default="network")
    parser.add_argument("--tuned", action="store_true", help="start from the pool's tuned gains")
    parser.add_argument("--hidden", type=int, nargs="*", default=[], help="hidden layers")
    parser.add_argument("--reward", choices=TERMS, default="leader_velocity")
    parser.add_argument("--generations", type=int, default=50)
    parser.add_argument(
        "--antithetic-pairs",
        "--pairs",
        dest="pairs",
        type=int,
        default=16,
        help="pairs of opposite perturbations",
    )
    parser.add_argument("--flocks", type=int, default=4, help="episodes for each candidate")
    parser.add_argument("--sigma", type=float, default=0.3, help="of the perturbations")
    parser.add_argument(
        "--learning-rate", "--rate", dest="rate", type=float, default=0.15, help="of Adam"
    )
    parser.add_argument(
        "--moving-average",
        "--average",
        dest="average",
        type=float,
        default=1.0,
        help="share of each generation in the result; 1: last",
    )
    parser.add_argument("--episodes", type=int, default=64, help="held-out episodes at the end")
    parser.add_argument("--seed", type=run_number, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/evolution"))
    parser.add_argument(
        "--engine",
        help="score candidates in parts: local, joblib or ray; in one batch if not given",
    )
    parser.add_argument("--workers", type=int, help="parts at a time; every core if not given")
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    counts = (options.pairs, options.generations, options.flocks)
    if min(*counts, *options.hidden, *options.leaders) < 1:
        parser.error("pairs, generations, flocks, hidden layers and leaders are at least 1")
    if options.workers is not None and options.workers < 1:
        parser.error("--workers is at least 1")
    if options.hidden and options.form != "network":
        parser.error("--hidden is for --form network")
    if options.tuned and options.form != "leaning":
        parser.error("--tuned is for --form leaning")
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/evolution_strategy.py", *given])
    path = options.out / "state.npz"
    with one_line_end(
        lambda: (
            f"the same command resumes from {path}" if path.exists() else "nothing is stored yet"
        )
    ):
        policy = search(options, command)
        ahead = flockenv.policies.StraightAhead(mirror_to_target=True)
        print_held_out(options, {"evolved": policy, "straight ahead": ahead})
    print(f"written to {options.out / 'policy.npz'}")


if __name__ == "__main__":
    main()
