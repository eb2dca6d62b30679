"""Environments by id, for ``gymnasium.make`` and ``gymnasium.make_vec``."""

from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
from gymnasium.envs.registration import EnvSpec

from flockenv.envs.ids import ENVIRONMENTS

ENTRY_POINT = "flockenv.envs.single:LeadersEnv"


def registered(is_ours: Callable[[Mapping[str, Any]], bool]) -> EnvSpec | None:
    """Return the first registered environment of leaders whose options are ours, if any is."""
    specs = (each for each in gymnasium.registry.values() if each.entry_point == ENTRY_POINT)
    return next((each for each in specs if is_ours(each.kwargs)), None)


def register() -> None:
    """Make the environments known to Gymnasium, once."""
    for env_id, each in ENVIRONMENTS.items():
        if env_id not in gymnasium.registry:
            gymnasium.register(
                id=env_id,
                entry_point=ENTRY_POINT,
                vector_entry_point="flockenv.envs.vector:LeadersVectorEnv",
                kwargs=dict(each.options),
            )
