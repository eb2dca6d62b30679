"""Environments by id, for ``gymnasium.make`` and ``gymnasium.make_vec``."""

from collections.abc import Mapping
from typing import Any

import gymnasium

__all__ = ["EASY_ID", "ENVIRONMENTS", "ENV_ID", "register"]

ENV_ID = "flockenv/Leaders-v0"

EASY_ID = "flockenv/Circulate-easy-v0"

ENVIRONMENTS: Mapping[str, Mapping[str, Any]] = {
    ENV_ID: {},
    # One leader among few boats, paid for its own motion at once: baselines/learn_easy.py.
    EASY_ID: {
        "n_boats": 9,
        "n_leaders": 1,
        "pool": "narrow",
        "control_hz": 5.0,
        "episode_s": 60.0,
        "reward": {"leader_velocity": 1.0},
    },
}
"""Registered ids, and the options in which each differs from the defaults."""


def register() -> None:
    """Make the environments known to Gymnasium, once."""
    for env_id, options in ENVIRONMENTS.items():
        if env_id not in gymnasium.registry:
            gymnasium.register(
                id=env_id,
                entry_point="flockenv.envs.single:LeadersEnv",
                vector_entry_point="flockenv.envs.vector:LeadersVectorEnv",
                kwargs=dict(options),
            )
