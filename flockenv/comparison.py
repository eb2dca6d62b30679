"""Leader policies against each other: seeded episodes, order by number of leaders (figure 12)."""

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from flockenv.extras import require
from flockenv.parameters import FlockParameters
from flockenv.policies import SteeringLaw
from flockenv.simulation import LeaderPolicy, simulate

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["NO_LEADERS", "POLICIES", "QUANTITIES", "compare_leaders"]

NO_LEADERS = "no leaders"
"""Name under which runs without leaders are listed."""

QUANTITIES = ("psi_o", "signed_order")
"""What is compared: mean Ψ_o and mean signed order of the normal boats."""

_CONTROL_HZ = 10.0


POLICIES: Mapping[str, Callable[[], LeaderPolicy]] = {"steering law": SteeringLaw}
"""Policies that can be compared by name."""


def compare_leaders(
    parameters: FlockParameters,
    leaders: Sequence[int],
    policies: Sequence[str],
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None] = lambda flock_seconds: None,
) -> "pd.DataFrame":
    """Run seeded episodes for every policy and number of leaders.

    Flocks with leaders are stepped through the Gymnasium vector environment with its default
    observation; flocks without run in `simulate`. Seed i gives the same initial placement and the
    same noise whatever the leaders do.

    Parameters
    ----------
    parameters
        The scene; its number of leaders is replaced.
    leaders
        Numbers of leaders; 0 is run once, whatever the policies.
    policies
        Names in `POLICIES`.
    seeds
        One episode each.
    duration_s
        Length of an episode in s.
    progress
        Called with flock-seconds as they are simulated.

    Returns
    -------
    pandas.DataFrame
        One row an episode: ``policy``, ``leaders``, ``seed``, ``psi_o``, ``signed_order``; both
        means over the 10 Hz frames in the analysis window after the first tenth.

    Raises
    ------
    ParameterError
        For parameters and durations out of range.
    KeyError
        For an unknown policy.
    """
    pandas = require("pandas", "plot")
    chosen = {name: POLICIES[name] for name in policies}
    parts = []
    if 0 in leaders:
        scene = parameters.replace(n_leaders=0)
        found = _without_leaders(scene, seeds, duration_s, progress)
        parts.append({"policy": NO_LEADERS, "leaders": 0, "seed": seeds, **found})
    for name, make in chosen.items():
        for k in (k for k in leaders if k > 0):
            scene = parameters.replace(n_leaders=k)
            found = _with_leaders(scene, make(), seeds, duration_s, progress)
            parts.append({"policy": name, "leaders": k, "seed": seeds, **found})
    tables = [pandas.DataFrame(part) for part in parts]
    runs: pd.DataFrame = pandas.concat(tables, ignore_index=True)
    return runs


def _with_leaders(
    scene: FlockParameters,
    policy: LeaderPolicy,
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None],
) -> dict[str, NDArray[np.float64]]:
    env = _environment(scene, len(seeds), duration_s)
    observations, _ = env.reset(seed=list(seeds))
    state, ended = None, np.zeros(len(seeds), np.bool_)
    infos: dict[str, Any] = {}
    while not ended.all():
        actions, state = policy.predict(observations, state)
        observations, _, _, ended, infos = env.step(actions)
        progress(len(seeds) / _CONTROL_HZ)
    summary = infos["episode_summary"]
    return {name: np.asarray(summary[name], np.float64) for name in QUANTITIES}


def _environment(scene: FlockParameters, num_envs: int, duration_s: float) -> Any:
    return gymnasium.make_vec(
        "flockenv/Leaders-v0",
        num_envs=num_envs,
        vectorization_mode="vector_entry_point",
        params=scene,
        target=scene.target,
        episode_s=duration_s,
        control_hz=_CONTROL_HZ,
        autoreset_mode="disabled",
    )


def _without_leaders(
    scene: FlockParameters,
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None],
) -> dict[str, NDArray[np.float64]]:
    # The environment derives a flock's seed from its own: ask it, to pair the runs.
    env = _environment(scene.replace(n_leaders=1), len(seeds), duration_s)
    _, infos = env.reset(seed=list(seeds))
    flock_seeds = [int(seed) for seed in infos["flock_seed"]]

    def run(seed: int) -> list[float]:
        recording = simulate(scene, seed, duration_s, _CONTROL_HZ, dtype=np.float32)
        frames = recording.in_analysis_window & (recording.time_s > 0.1 * duration_s)
        signed = recording.order.signed_order(scene.target)
        progress(duration_s)
        return [recording.order.psi_o[frames].mean(), signed[frames].mean()]

    # Threads suffice: the simulator lets go of the interpreter while it runs.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        means = np.array(list(pool.map(run, flock_seeds)))
    return dict(zip(QUANTITIES, means.T, strict=True))
