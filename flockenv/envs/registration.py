"""Environments by id, for ``gymnasium.make`` and ``gymnasium.make_vec``."""

from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
from gymnasium.envs.registration import EnvSpec

ENV_ID = "flockenv/Leaders-v0"

EASY_ID = "flockenv/Order-easy-v0"

ENVIRONMENTS: Mapping[str, Mapping[str, Any]] = {
    ENV_ID: {},
    # Few boats, many leaders and few numbers observed, so that samples show the order:
    # baselines/learn_easy.py.
    EASY_ID: {
        "n_boats": 10,
        "n_leaders": 4,
        "pool": "narrow",
        "bw_s": 0.3,
        "target": "random",
        "mirror_to_target": True,
        "observation": {"neighbors": 0, "target": False},
        "control_hz": 2.5,
        "episode_s": 120.0,
        "reward": {"signed_order": 1.0},
        "physics": "training",
    },
}
"""Registered ids, and the options in which each differs from the defaults."""


ENTRY_POINT = "flockenv.envs.single:LeadersEnv"


def registered(is_ours: Callable[[Mapping[str, Any]], bool]) -> EnvSpec | None:
    """Return the first registered environment of leaders whose options are ours, if any is."""
    specs = (each for each in gymnasium.registry.values() if each.entry_point == ENTRY_POINT)
    return next((each for each in specs if is_ours(each.kwargs)), None)


def register() -> None:
    """Make the environments known to Gymnasium, once."""
    for env_id, options in ENVIRONMENTS.items():
        if env_id not in gymnasium.registry:
            gymnasium.register(
                id=env_id,
                entry_point=ENTRY_POINT,
                vector_entry_point="flockenv.envs.vector:LeadersVectorEnv",
                kwargs=dict(options),
            )
