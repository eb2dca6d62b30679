"""Search a leader policy with an evolution strategy, with NumPy and flockenv alone, or by CMA-ES.

    python baselines/evolution_strategy.py                          # an easy flock, two minutes
    python baselines/evolution_strategy.py --pool narrow --boats 27 --leaders 3 --noise 1 \
        --control-hz 10 --episode-s 120 --reward signed_order --generations 300 \
        --out results/evolution/narrow

Gaussian perturbations of all weights are tried in antithetic pairs, with one or several flocks for
each, all in one batch of the simulator. Candidates of a generation steer the same episodes, so that
they differ by their weights alone. Their mean rewards are replaced by ranks, and Adam follows the
estimated gradient. CMA-ES takes the candidates' order instead (--method). The policy is linear
feedback on the observation unless hidden layers are given; with --form leaning it is a
`LeaningLaw`, which starts as the damped law or as that of --start, and with --form nonlinear a
`LeaningLaw` with hidden units. With several numbers of leaders or scenarios, generations get them
in turn. An interrupted command resumes from the last generation. The result is a policy file:

    flockenv compare --policy "steering law" --policy results/evolution/policy.npz
"""

import argparse
import json
import shlex
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from policy_forms import Form, LeaningShape, Shape, features_of, law_observing
from rich.progress import Progress
from run_number import run_number
from script_end import one_line_end
from search_methods import METHODS, Method
from search_scenarios import (
    POOLS,
    TARGETS,
    Part,
    Scenario,
    Turns,
    environment,
    mean_rewards,
    noise,
    scenarios_of,
    scores,
    scores_on_engine,
    unscored_steps,
)

import flockenv
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv._io.atomic_write import write_text
from flockenv._io.npz_header import array_of
from flockenv._io.provenance import provenance_of
from flockenv.envs.observation import observation_entries, observation_version
from flockenv.envs.reward import TERMS
from flockenv.policies import DampedLaw, LeaningLaw, NetworkPolicy, load
from flockenv.policies.pretrained import TUNED_GAINS
from flockenv.runs.seeds import POLICY_SEEDS

SEEDS = POLICY_SEEDS["evolution strategy"]
ROUGH_GAINS = {"gain": 1.9, "backward_gain": 3.0, "damping": 20.0}
LEANING = ("leaning", "nonlinear")
#: Hidden units of a nonlinear law.
UNITS = 4
#: Options that earlier states do not name, with what they were then.
ADDED = {
    "method": "evolution-strategy",
    "scenario": [],
    "target": "random",
    "start": None,
    "fellow_leaders": 0,
}


@dataclass
class State:
    """Where the search is: all that the next generation depends on."""

    generation: int
    method: Method
    average: np.ndarray
    wall_s: float
    curve: np.ndarray


def start_law(options: argparse.Namespace) -> DampedLaw | LeaningLaw:
    """Return the law that a search of leaning laws starts from, for what its leaders observe."""
    blocks = blocks_of(options.fellow_leaders)
    if options.start is None:
        gains = TUNED_GAINS["damped law"][options.pool] if options.tuned else ROUGH_GAINS
        return law_observing(DampedLaw(**gains), blocks)
    law = load(options.start)
    if not isinstance(law, LeaningLaw):
        raise flockenv.ParameterError(f"--start {options.start} is a {law!r}, not a leaning law")
    units = len(law.hidden) if law.hidden else 0
    most = sum(options.hidden) if options.form == "nonlinear" else 0
    if units > most:
        raise flockenv.ParameterError(
            f"--start {options.start} has {units} hidden units, and the form has {most}: "
            f"--form nonlinear --hidden {units}"
        )
    return law_observing(law, {**law.observation, **blocks})


def form_of(options: argparse.Namespace) -> Form:
    """Return what is searched; a leaning law is measured in the flocks of the search."""
    if options.form == "network":
        blocks = blocks_of(options.fellow_leaders)
        return Shape(len(observation_entries(blocks)), options.hidden, blocks)
    law, seeds = start_law(options), list(SEEDS.seeds(16, options.seed))
    scenarios = scenarios_of(options)
    watched = []
    for scenario in dict.fromkeys(scenarios) if options.scenario else scenarios[:1]:
        env = environment(options, len(seeds), scenario, law.observation)
        watched.append((env, seeds, round(min(60.0, scenario.episode_s) * options.control_hz)))
    nonlinear = options.form == "nonlinear"
    wanted = features_of(law, every=nonlinear)
    units = sum(options.hidden) if nonlinear else 0
    return LeaningShape(law, watched, wanted, units, np.random.default_rng([options.seed, 0, 1]))


def next_generation(
    state: State,
    env: flockenv.LeadersVectorEnv,
    shape: Form,
    options: argparse.Namespace,
    scenario: Scenario,
) -> State:
    method, number = state.method, state.generation
    candidates = method.candidates()
    seeds = list(SEEDS.seeds(options.flocks, options.seed, number * options.flocks))
    if options.engine is None:
        unscored = unscored_steps(options, scenario)
        found = scores(env, shape, candidates, seeds, unscored)
    else:
        found = scores_on_engine(Part(options, scenario, shape, candidates, seeds))
    method.learn(candidates, found)
    average = state.average + options.average * (method.mean - state.average)
    curve = np.append(state.curve, found.mean())
    return State(number + 1, method, average, state.wall_s, curve)


def identity(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options that a stored search must share to be resumed."""
    free = ("out", "generations", "flock_hours", "quiet", "episodes", "engine", "workers")
    whole = {"observation_version": None, "first_seed": SEEDS.first, **given}
    if whole["observation_version"] is None:
        blocks = blocks_of(whole.get("fellow_leaders", 0))
        whole["observation_version"] = observation_version(blocks)
    return {
        name: value
        for name, value in whole.items()
        if name not in free and (name not in ADDED or value != ADDED[name])
    }


def reported(options: argparse.Namespace) -> dict[str, Any]:
    """Return options as a state holds them: the digest of the first law instead of its path."""
    start = None if options.start is None else start_law(options).digest
    whole = identity({**vars(options), "start": start})
    found: dict[str, Any] = json.loads(json.dumps(whole))
    return found


def blocks_of(fellow_leaders: int) -> dict[str, Any]:
    """Return the blocks that differ from the default layout."""
    return {"fellow_leaders": fellow_leaders} if fellow_leaders else {}


def load_state(path: Path, options: argparse.Namespace, first: np.ndarray) -> State | None:
    if not path.exists():
        return None
    arrays = read_arrays(path)
    try:
        stored = identity(json.loads(str(arrays["identity"])))
        numbers = {name: arrays[name] for name in ("generation", "average", "wall_s", "curve")}
    except (KeyError, TypeError, ValueError) as error:
        raise flockenv.ParameterError(f"{path} is no state of a search") from error
    if stored != reported(options):
        raise flockenv.ParameterError(
            f"{path} is of a search with other options: name another folder with --out"
        )
    generation = numbers["generation"]
    if generation.shape != () or generation.dtype.kind != "i" or generation < 0:
        raise flockenv.ParameterError(f"{path} is no state of a search: generation")
    number = int(generation)
    kind = METHODS[options.method]
    # What a method stores of every generation is empty before the first one.
    stored_by_method = {
        name: (number, *each.shape[1:]) if len(each) == 0 else each.shape
        for name, each in kind(first, options).arrays().items()
    }
    shapes = {"average": first.shape, "curve": (number,), "wall_s": (), **stored_by_method}
    for name, shape in shapes.items():
        try:
            whole = np.isfinite(array_of(arrays, name, shape)).all()
        except flockenv.ParameterError as error:
            raise flockenv.ParameterError(f"{path} is no state of a search: {error}") from error
        if not whole:
            raise flockenv.ParameterError(f"{path} is no state of a search: {name} is not finite")
    method = kind.resumed(first, options, arrays)
    return State(number, method, numbers["average"], float(numbers["wall_s"]), numbers["curve"])


def save_state(path: Path, state: State, options: argparse.Namespace, turns: Turns) -> None:
    arrays = state.method.arrays()
    for name in ("generation", "average", "wall_s", "curve"):
        arrays[name] = np.asarray(getattr(state, name))
    arrays["flock_hours"] = np.asarray(turns.flock_hours(state.generation))
    write_arrays(path, {**arrays, "identity": np.array(json.dumps(reported(options)))})


def write_curve(path: Path, curve: np.ndarray, turns: Turns) -> None:
    """Write the mean reward of each generation, with the flock-hours up to its end."""
    lines = ["generation,flock_hours,pool,leaders,target,mean_reward"]
    hours = 0.0
    for generation, reward in enumerate(curve.tolist()):
        each = turns.of(generation)
        hours += turns.flocks * each.episode_s / 3600
        lines.append(
            f"{generation},{hours:.4f},{each.pool},{each.leaders},{each.target},{reward:.6f}"
        )
    write_text(path, "\n".join(lines) + "\n")


def search(options: argparse.Namespace, command: str) -> NetworkPolicy | LeaningLaw:
    turns, shape = Turns(options), form_of(options)
    envs = {
        each: environment(options, turns.flocks, each, shape.blocks) for each in turns.scenarios
    }
    path = options.out / "state.npz"
    options.out.mkdir(parents=True, exist_ok=True)
    first = shape.first(np.random.default_rng(options.seed))
    state = load_state(path, options, first)
    if state is None:
        method = METHODS[options.method](first, options)
        state = State(0, method, first, 0.0, np.empty(0))
    start = time.perf_counter() - state.wall_s
    with Progress(disable=options.quiet) as progress:
        task = progress.add_task("", total=turns.most, completed=state.generation)
        while not turns.are_over(state.generation):
            scenario = turns.of(state.generation)
            state = next_generation(state, envs[scenario], shape, options, scenario)
            state.wall_s = time.perf_counter() - start
            save_state(path, state, options, turns)
            write_curve(options.out / "curve.csv", state.curve, turns)
            words = f"mean reward of the candidates {state.curve[-1]:.3f}"
            progress.update(task, description=words, completed=state.generation)
    provenance = provenance_of(
        command,
        seed=options.seed,
        samples=turns.samples(state.generation),
        wall_s=state.wall_s,
        flock_hours=turns.flock_hours(state.generation),
    )
    policy = shape.policy(state.average, provenance)
    policy.save(options.out / "policy.npz")
    return policy


def print_held_out(options: argparse.Namespace, policies: dict[str, Any]) -> None:
    """Print the rewards of policies in episodes that the search has not used."""
    every = scenarios_of(options)
    scenarios = list(dict.fromkeys(every)) if options.scenario else []
    seeds = list(POLICY_SEEDS["evaluation"].seeds(options.episodes))
    for scenario in scenarios or every[:1]:
        if scenarios:
            print(scenario)
        unscored = unscored_steps(options, scenario)
        for label, policy in policies.items():
            env = environment(options, options.episodes, scenario, policy.observation)
            steer = lambda rows, policy=policy: policy.predict(rows)[0]  # noqa: E731
            found = mean_rewards(env, seeds, steer, unscored)
            for name, values in zip((options.reward, "signed order"), found, strict=True):
                half = 1.96 * values.std(ddof=1) / np.sqrt(options.episodes)
                print(f"{label}: mean {name} {values.mean():.3f} ± {half:.3f}")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=POOLS, default="wide")
    parser.add_argument("--boats", type=int, default=6, help="leaders included")
    parser.add_argument(
        "--leaders", type=int, nargs="+", default=[2], help="of the generations in turn"
    )
    parser.add_argument(
        "--noise",
        type=noise,
        default=0.3,
        help="1: the pool's critical noise; 0.5..1.25: drawn for each episode",
    )
    parser.add_argument(
        "--target",
        choices=TARGETS,
        default="random",
        help="alternate: rewards count from its first switch on",
    )
    parser.add_argument(
        "--scenario",
        action="append",
        default=[],
        metavar="NAME=VALUE,...",
        help="pool, boats, leaders, noise, target, episode-s; repeated: of generations in turn",
    )
    parser.add_argument("--control-hz", type=float, default=2.0)
    parser.add_argument("--episode-s", type=float, default=60.0)
    parser.add_argument("--liberal-steps", action="store_true", help="dt_s 0.1, one pass")
    parser.add_argument(
        "--set", action="append", default=[], metavar="FIELD=VALUE", help="of FlockParameters"
    )
    parser.add_argument("--form", choices=("network", *LEANING), default="network")
    parser.add_argument("--tuned", action="store_true", help="start from the pool's tuned gains")
    parser.add_argument("--start", help="file of a leaning law to start from")
    parser.add_argument(
        "--hidden", type=int, nargs="*", default=[], help="hidden layers; units of a nonlinear law"
    )
    parser.add_argument(
        "--fellow-leaders", type=int, default=0, help="how many leaders observe of their own"
    )
    parser.add_argument("--method", choices=METHODS, default="evolution-strategy")
    parser.add_argument("--reward", choices=TERMS, default="leader_velocity")
    parser.add_argument("--generations", type=int, help="50, if no flock-hours are given")
    parser.add_argument("--flock-hours", type=float, help="simulated time that ends the search")
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
    generations = 1 if options.generations is None else options.generations
    counts = (options.pairs, generations, options.flocks)
    if min(*counts, *options.hidden, *options.leaders) < 1:
        parser.error("pairs, generations, flocks, hidden layers and leaders are at least 1")
    if options.episodes < 2:
        parser.error("--episodes is at least 2")
    if not (0.0 < options.sigma < np.inf and 0.0 < options.rate < np.inf):
        parser.error("--sigma and --learning-rate are positive")
    if not 0.0 < options.average <= 1.0:
        parser.error("--moving-average is above 0 and at most 1")
    if options.workers is not None and options.workers < 1:
        parser.error("--workers is at least 1")
    if options.flock_hours is not None and not 0.0 < options.flock_hours < np.inf:
        parser.error("--flock-hours is positive")
    if not 0 <= options.fellow_leaders <= 64:
        parser.error("--fellow-leaders is from 0 to 64")
    if options.hidden and options.form == "leaning":
        parser.error("--hidden is for --form network and nonlinear")
    if options.form == "nonlinear" and len(options.hidden) > 1:
        parser.error("--form nonlinear has one hidden layer")
    if options.form == "nonlinear" and not options.hidden:
        options.hidden = [UNITS]
    for name in ("tuned", "start"):
        if getattr(options, name) and options.form not in LEANING:
            parser.error(f"--{name} is for --form leaning and nonlinear")
    if options.tuned and options.start:
        parser.error("--tuned and --start exclude each other")
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
