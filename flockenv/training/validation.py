"""How good a policy is while it is trained: the same seeded episodes each time."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from flockenv.comparison.episodes import run_episodes
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.training.settings import TrainingSettings

__all__ = ["validation_episodes", "validation_flocks", "validation_names", "validation_scores"]


def validation_scores(policy: LeaderPolicy, settings: TrainingSettings) -> dict[str, float]:
    """Return the mean signed order of a policy at the critical noise, over paired seeds.

    Returns
    -------
    dict
        One number for each pool, number of leaders and, without mirroring, direction.
    """
    episodes = validation_episodes(lambda pool: policy, settings)
    return {name: float(np.mean(orders)) for name, orders in episodes.items()}


def validation_episodes(
    policy_of: Callable[[str], LeaderPolicy], settings: TrainingSettings
) -> dict[str, NDArray[np.float64]]:
    """Return the signed order of each episode of a validation, in the order of its seeds.

    Parameters
    ----------
    policy_of
        The policy in each pool, by the pool's name. What its actions stand for is its own.
    settings
        Where and how long, and how many episodes.

    Returns
    -------
    dict
        Shape (episodes,) by the names of `validation_scores`.
    """
    seeds = POLICY_SEEDS["validation"].seeds(settings.validation_episodes)
    options = {**settings.options, "control_hz": settings.validation_hz}
    options = {name: each for name, each in options.items() if name not in settings.decisions}
    episodes = {}
    for name, parameters in validation_flocks(settings):
        policy, duration_s = policy_of(str(parameters.pool)), settings.validation_s
        found = run_episodes(parameters, policy, seeds, duration_s, options=options)
        episodes[name] = found["signed_order"]
    return episodes


def validation_names(settings: TrainingSettings) -> list[str]:
    """Return the names of the scores, in order."""
    return [name for name, _ in validation_flocks(settings)]


def validation_flocks(settings: TrainingSettings) -> Iterator[tuple[str, FlockParameters]]:
    """Yield the name and the parameters of each flock that policies are judged in."""
    preset = FlockParameters.preset(settings.preset).replace(n_boats=settings.n_boats)
    # Mirrored, both directions are one task.
    targets = ("cw",) if settings.mirror_to_target else ("cw", "ccw")
    for pool in settings.pools:
        parameters = preset.replace(
            pool=pool, bw_s=FlockParameters.critical_bw_s(settings.preset, pool)
        )
        for k in sorted(set(settings.n_leaders)):
            for target in targets:
                name = f"{pool} k={k}" + ("" if settings.mirror_to_target else f" {target}")
                yield name, parameters.replace(n_leaders=k, target=target)
