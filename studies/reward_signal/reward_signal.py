"""Measure how clearly samples show the policy gradient, before a training is spent on a reward.

    python -m studies.reward_signal.reward_signal --from "straight ahead" --to "tuned law"
    python -m studies.reward_signal.reward_signal --action-mode lean --shared --hold-s 24

Rudders show the tuned law at 3.6 standard errors by `leader_velocity` and at -1.2 by the order,
with a million samples in `wide` (`--seed 0`, 256 flocks, 16 s of one core; results version 5).

Leaders explore about the mean action of one policy: a = mu(s) + sigma * e. Along the direction d(s)
to the mean actions of another policy the policy gradient is E[e * d(s) / sigma * A], where A is the
return less a baseline, which is linear in what the leader observes and in the features of its flock
and is fitted to the other half of the flocks. Each flock's episode gives an estimate. Their mean
over its standard error is the significance z. It grows with the square root of the samples
(decisions of leaders), so that z per million samples compares rewards, horizons and action modes.
Positive: the reward grows towards the other policy. The page beside it has what it
found, by

    python -m studies.reward_signal.reward_signal --pool wide --horizon 30 --flocks 256
    python -m studies.reward_signal.reward_signal --pool narrow --horizon 30 --flocks 256
    python -m studies.reward_signal.reward_signal --pool wide --horizon 30 --flocks 256 \\
        --action-mode lean --shared --hold-s 24 --to learned
"""

import argparse
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from flockenv.policies import LeaningLaw, StraightAhead
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv
from studies.store import check_version, write_table
from studies.study import run

REWARDS = ("leader_velocity", "contact_push", "contact_alignment", "signed_order")
#: Rows that a baseline is fitted to, about.
ROWS = 20_000


class Constant(StraightAhead):
    """The same action at all times, as an end of a direction."""

    def __init__(self, value: float, **layout: Any) -> None:
        super().__init__(**{"mirror_to_target": True, **layout})
        self.value = value

    def predict(self, observation: Any, *_: Any, **__: Any) -> tuple[Any, None]:
        actions, _state = super().predict(observation)
        return np.full_like(actions, self.value), None


def policy_of(name: str, pool: str, **layout: Any) -> Any:
    """Return a policy by name or file, or the constant action of a number in a layout."""
    try:
        return Constant(float(name), **layout)
    except ValueError:
        return flockenv.policies.policy(name, pool)


def episode(env: Any, policies: Any, options: Any, random: Any, seeds: Any) -> dict[str, Any]:
    """Return scores, inputs of the baseline and reward terms: shape (decisions, rows, ...) each."""
    env.seed(seeds[0])
    seen, scores, inputs, terms = env.reset(), [], [], []
    hold, flock = max(1, round(options.hold_s * env.decisions_hz)), env.flock_of_slot
    over = False
    while not over:
        if len(scores) % hold == 0:
            noise = random.standard_normal(env.num_flocks if options.shared else env.num_envs)
            noise = noise[flock] if options.shared else noise
        mean, other = (np.asarray(each.predict(seen)[0], float).ravel() for each in policies)
        inputs.append(np.concatenate([seen, env.flock_features()], axis=1))
        scores.append(noise * (other - mean) / options.deviation)
        actions = np.clip(mean + options.deviation * noise, -1.0, 1.0)
        seen, _, ended, _ = env.step(actions[:, None])
        terms.append(env.reward_terms())
        over = bool(ended.all())
    stacked = {name: np.array([each[name] for each in terms]) for name in REWARDS}
    return {"scores": np.array(scores), "inputs": np.array(inputs), **stacked}


def estimates(found: Mapping[str, Any], reward: str, gamma: float, leaders: int) -> np.ndarray:
    """Return an estimate of the gradient for each flock."""
    scores, inputs = found["scores"], found["inputs"]
    returns, share = np.zeros_like(scores), np.zeros(len(scores))
    later, left = np.zeros(scores.shape[1]), 0.0
    for step in reversed(range(len(scores))):
        later = (1.0 - gamma) * found[reward][step] + gamma * later
        left = (1.0 - gamma) + gamma * left
        returns[step], share[step] = later, left
    # Near the end of the episode returns hold a share of the horizon alone.
    design = np.concatenate([inputs, np.ones((*inputs.shape[:2], 1), inputs.dtype)], axis=2)
    design *= share[:, None, None]
    half = scores.shape[1] // 2 // leaders * leaders
    some, advantage = slice(None, None, max(1, returns.size // ROWS)), np.empty_like(returns)
    for own, other in ((slice(half), slice(half, None)), (slice(half, None), slice(half))):
        fitted = design[some, other].reshape(-1, design.shape[2])
        solved, *_ = np.linalg.lstsq(fitted, returns[some, other].ravel(), rcond=None)
        advantage[:, own] = returns[:, own] - design[:, own] @ solved
    gains = (scores * advantage).reshape(len(scores), -1, leaders)
    return gains.sum(axis=(0, 2))


def significance(values: np.ndarray, samples: int) -> tuple[float, float]:
    """Return z per million samples, and its standard error."""
    z = float(values.mean() / values.std(ddof=1) * math.sqrt(len(values)))
    scale = math.sqrt(1e6 / samples)
    # Of a mean over a deviation that is estimated, too.
    return z * scale, scale * math.sqrt(1.0 + z * z / (2.0 * len(values)))


def measured(options: argparse.Namespace) -> list[dict[str, Any]]:
    """Return z per million samples of each reward and horizon."""
    other = policy_of(options.to, options.pool)
    if options.action_mode == "lean" and isinstance(other, LeaningLaw):
        period_s = other.decision_period_s or 2.0
        other = LeaningLaw(other.pool, other.bias, other.weights, decision_period_s=period_s)
    layout = {"observation": other.observation, "mirror_to_target": other.mirror_to_target}
    period_s = getattr(other, "decision_period_s", None) or 1.0
    policies = policy_of(options.start, options.pool, **layout), other
    env = LeaderVecEnv(
        options.flocks,
        pool=options.pool,
        n_boats=27,
        n_leaders=options.leaders,
        bw_s=flockenv.FlockParameters.critical_bw_s("simulation", options.pool),
        action_mode=options.action_mode,
        control_hz=10.0 if options.action_mode == "lean" else 5.0,
        decision_period_s=period_s if options.action_mode == "lean" else None,
        episode_s=60.0 * options.minutes,
        reward=dict.fromkeys(REWARDS, 1.0),
        physics="training",
        **layout,
    )
    seeds = POLICY_SEEDS["training"].seeds(options.flocks, options.seed)
    random = np.random.default_rng(options.seed)
    found = episode(env, policies, options, random, seeds)
    rows = []
    for reward in REWARDS:
        for horizon_s in options.horizon:
            gamma = math.exp(-1.0 / (horizon_s * env.decisions_hz))
            values = estimates(found, reward, gamma, options.leaders)
            z, error = significance(values, found["scores"].size)
            row = {"pool": options.pool, "action_mode": options.action_mode, "reward": reward}
            numbers = {"horizon_s": horizon_s, "z_per_million": z, "error": error}
            rows.append({**row, **numbers, "samples": found["scores"].size})
    return rows


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=("wide", "narrow"), default="narrow")
    parser.add_argument("--leaders", type=int, default=3)
    parser.add_argument("--action-mode", choices=("rudder", "lean"), default="rudder")
    parser.add_argument("--from", dest="start", help="[straight ahead; 0 for leans]")
    parser.add_argument("--to", help="[tuned law; 1 for leans]")
    parser.add_argument("--horizon", type=float, nargs="+", default=[8.0, 30.0], help="in s")
    parser.add_argument("--deviation", type=float, default=0.3, help="of the exploration")
    parser.add_argument("--hold-s", type=float, default=0.0, help="time that a noise is held")
    parser.add_argument("--shared", action="store_true", help="one noise for a flock's leaders")
    parser.add_argument("--flocks", type=int, default=128)
    parser.add_argument("--minutes", type=float, default=4.0, help="length of an episode")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/signal/signals.csv"))
    options = parser.parse_args(arguments)
    if options.flocks < 4 or options.flocks % 2:
        parser.error("--flocks is even and at least 4")
    check_version(options.out)
    leans = options.action_mode == "lean"
    options.start = options.start or ("0" if leans else "straight ahead")
    options.to = options.to or ("1" if leans else "tuned law")
    rows = measured(options)
    write_table(options.out, pd.DataFrame(rows))
    for row in rows:
        z = f"{row['z_per_million']:+.1f} ± {row['error']:.1f}"
        print(f"{row['reward']}, horizon {row['horizon_s']:g} s: z per million samples {z}")
    print(f"written to {options.out}")


if __name__ == "__main__":
    run(main, resumes=False)
