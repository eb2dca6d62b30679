"""Environments by id, for ``gymnasium.make``, ``gymnasium.make_vec`` and ``pettingzoo.make``."""

from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
import pettingzoo
from gymnasium.envs.registration import EnvSpec

from flockenv.envs.ids import ENVIRONMENTS

ENTRY_POINT = "flockenv.envs.single:LeadersEnv"

_PETTINGZOO_ENTRY_POINTS = {
    "parallel": "flockenv.envs.parallel:parallel_env",
    "aec": "flockenv.envs.parallel:env",
}


def register() -> None:
    """Make the environments known to Gymnasium and PettingZoo."""
    for env_id, environment in ENVIRONMENTS.items():
        if env_id in gymnasium.registry:
            continue
        gymnasium.register(
            id=env_id,
            entry_point=ENTRY_POINT,
            vector_entry_point="flockenv.envs.vector:LeadersVectorEnv",
            kwargs=dict(environment.options),
            # The environment itself refuses a step before a reset, and options as attributes. A
            # wrapper would take such attributes for itself.
            order_enforce=False,
            disable_env_checker=True,
        )
        # PettingZoo before version 1.27 has no ids.
        if hasattr(pettingzoo, "register"):
            for kind, entry_point in _PETTINGZOO_ENTRY_POINTS.items():
                pettingzoo.register(kind, env_id, entry_point, kwargs=dict(environment.options))


def registered(accepts: Callable[[Mapping[str, Any]], bool]) -> EnvSpec | None:
    """Return the first of the ids' specs whose options `accepts` takes; None if it takes none."""
    specs = (spec for spec in gymnasium.registry.values() if spec.entry_point == ENTRY_POINT)
    return next((spec for spec in specs if accepts(spec.kwargs)), None)
