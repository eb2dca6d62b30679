"""RLlib's module of leaders that share one network, for the native vector environment.

Needs the extra ``ray``: ``pip install flockenv[ray] torch``.
"""

from flockenv._io.extras import require

require("ray.rllib", "ray")
require("torch", "train")

# ruff: noqa: E402 - after the check above
from flockenv.rllib.leaders_module import LeadersModule

__all__ = ["LeadersModule"]
