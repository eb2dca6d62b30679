"""How good a policy is while it is trained: the same seeded episodes each time."""

from collections.abc import Iterator

import numpy as np

from flockenv.comparison.episodes import run_episodes
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.training.settings import TrainingSettings

__all__ = ["validation_names", "validation_scores"]


def validation_scores(policy: LeaderPolicy, settings: TrainingSettings) -> dict[str, float]:
    """Return the mean signed order of a policy at the critical noise, over paired seeds.

    Returns
    -------
    dict
        One number for each pool, number of leaders and, without mirroring, direction.
    """
    seeds = POLICY_SEEDS["validation"].seeds(settings.validation_episodes)
    options = {**settings.options, "control_hz": settings.validation_hz}
    scores = {}
    for name, parameters in _flocks(settings):
        found = run_episodes(parameters, policy, seeds, settings.validation_s, options=options)
        scores[name] = float(np.mean(found["signed_order"]))
    return scores


def validation_names(settings: TrainingSettings) -> list[str]:
    """Return the names of the scores, in order."""
    return [name for name, _ in _flocks(settings)]


def _flocks(settings: TrainingSettings) -> Iterator[tuple[str, FlockParameters]]:
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
