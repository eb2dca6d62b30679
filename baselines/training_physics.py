"""Measure what ``physics="training"`` does to order parameters, policies, and learning.

    python baselines/training_physics.py                      # 64 episodes, policies trained again
    python baselines/training_physics.py --episodes 8 --samples 0

Training physics step a flock by dt_s = 0.1 s with one relinearization instead of 0.02 s with none.
The same seeds give both the same starts; noise is drawn per substep, and differs. The first table
compares order without leaders and the signed order of policies that were trained at the default;
the second compares policies that PPO trained here for some samples with either physics, both
evaluated at the default. The page goes to docs/training_physics.md.
"""

import argparse
import shlex
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from flockenv import FlockParameters, _core
from flockenv.comparison.episodes import compare_leaders
from flockenv.policies.base import LeaderPolicy
from flockenv.policies.laws import LAWS
from flockenv.policies.pretrained import learned, load
from flockenv.training.ppo import train
from flockenv.training.settings import TrainingSettings

RESULTS = Path(__file__).parents[1] / "docs" / "training_physics.md"
PHYSICS = ("default", "training")
LEADERS = 3
DURATION_S = 480.0
Policies = dict[str, Callable[[], LeaderPolicy | str]]


def flock_parameters(pool: str, physics: str) -> FlockParameters:
    """Return 27 boats at the critical noise of their pool."""
    critical = FlockParameters.critical_bw_s("simulation", pool)
    parameters = FlockParameters.preset("simulation").replace(n_boats=27, pool=pool, bw_s=critical)
    return parameters.replace(**_core.physics_fields(physics))


def measured(
    pool: str, physics: str, leaders: list[int], policies: Policies, episodes: int
) -> dict[str, Any]:
    """Return each policy's values, an episode each."""
    runs = compare_leaders(
        flock_parameters(pool, physics), leaders, policies, list(range(episodes)), DURATION_S
    )
    return {str(name): group for name, group in runs.groupby("policy")}


def interval(values: np.ndarray) -> str:
    """Return a mean with the half-width of its 95 % interval."""
    half = 1.96 * values.std(ddof=1) / np.sqrt(len(values))
    return f"{values.mean():.3f} ± {half:.3f}"


def compared(name: str, pool: str, default: np.ndarray, training: np.ndarray) -> str:
    """Return a row of a table: both values and their difference, seed by seed."""
    cells = [name, f"`{pool}`", interval(default), interval(training)]
    return f"| {' | '.join([*cells, interval(training - default)])} |"


def order_rows(pool: str, episodes: int) -> list[str]:
    """Return rows on order without leaders and on the signed order of policies."""
    laws: Policies = {"steering law": LAWS["steering law"], "learned": lambda: learned(pool)}
    found = [measured(pool, physics, [0, LEADERS], laws, episodes) for physics in PHYSICS]
    rows = []
    for name in found[0]:
        quantity = "psi_o" if name == "no leaders" else "signed_order"
        values = [each[name][quantity].to_numpy() for each in found]
        symbol = "mean Ψ_o" if quantity == "psi_o" else "signed order"
        rows.append(compared(f"{symbol}, {name}", pool, *values))
    return rows


def trained(pool: str, physics: str, samples: int) -> LeaderPolicy:
    """Return a policy that PPO trained for so many samples."""
    settings = TrainingSettings(
        samples=samples, pools=(pool,), options={"physics": physics}, validate_every=samples
    )
    with tempfile.TemporaryDirectory() as folder:
        train(settings, Path(folder) / "run")
        return load(sorted((Path(folder) / "run").glob("*.npz"))[-1])


def _same(policy: LeaderPolicy) -> LeaderPolicy:
    return policy


def learning_row(pool: str, samples: int, episodes: int) -> str:
    """Return a row on policies trained with either physics, evaluated at the default."""
    policies = {physics: trained(pool, physics, samples) for physics in PHYSICS}
    makers: Policies = {name: partial(_same, policy) for name, policy in policies.items()}
    found = measured(pool, "default", [LEADERS], makers, episodes)
    values = [found[physics]["signed_order"].to_numpy() for physics in PHYSICS]
    return compared(f"signed order, PPO of {samples:,} samples", pool, *values)


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=64)
    parser.add_argument("--samples", type=int, default=1_000_000, help="0 trains nothing")
    parser.add_argument("--pools", nargs="+", default=["wide", "narrow"])
    parser.add_argument("--out", type=Path, default=RESULTS)
    given = parser.parse_args()
    command = shlex.join(["baselines/training_physics.py", *sys.argv[1:]])
    head = [
        "| quantity | pool | default | training | difference |",
        "| --- | --- | --- | --- | --- |",
    ]
    lines = [
        "# Training physics",
        "",
        f"`python {command}` measured this page on {given.episodes} episodes of "
        f"{DURATION_S:.0f} s, seeds from 0, with 27 boats and {LEADERS} leaders at the critical "
        "noise of each pool. Values are means with 95 % intervals, differences are taken seed by "
        "seed. A seed gives both the same start; noise is drawn per substep, and differs.",
        "",
        '`physics="training"` steps by 0.1 s with one relinearization, the default by 0.02 s with '
        "none. The policies were trained at the default.",
        "",
        *head,
    ]
    for pool in given.pools:
        lines += order_rows(pool, given.episodes)
    if given.samples:
        lines += [
            "",
            "Policies trained here with either physics, evaluated at the default:",
            "",
            *head,
        ]
        lines += [learning_row(pool, given.samples, given.episodes) for pool in given.pools]
    given.out.write_text("\n".join([*lines, ""]), encoding="utf-8")
    print(given.out.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
