"""``gymnasium.make("flockenv/Leaders-v0")`` and ``gymnasium.make_vec`` of the same name."""

import gymnasium

__all__ = ["ENV_ID", "register"]

ENV_ID = "flockenv/Leaders-v0"


def register() -> None:
    """Make the environment known to Gymnasium, once."""
    if ENV_ID in gymnasium.registry:
        return
    gymnasium.register(
        id=ENV_ID,
        entry_point="flockenv.envs.single:LeadersEnv",
        vector_entry_point="flockenv.envs.vector:LeadersVectorEnv",
    )
