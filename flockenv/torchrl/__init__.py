"""TorchRL's environment over one batch of flocks, its leaders a group of agents.

Needs the extra ``torchrl``: ``pip install flockenv[torchrl]``.
"""

from flockenv._io.extras import require

require("torchrl", "torchrl")

# ruff: noqa: E402 - after the check above
from flockenv.torchrl.leaders_env import GROUP, STATES, LeadersEnv

__all__ = ["GROUP", "STATES", "LeadersEnv"]
