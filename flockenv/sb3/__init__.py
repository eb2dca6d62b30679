"""Leaders as slots of stable-baselines3's vector interface, and evaluation by episodes of flocks.

Needs the extra ``train``.
"""

from flockenv._io.extras import require

require("stable_baselines3", "train")

# ruff: noqa: E402 - after the check above
from flockenv.sb3.evaluation import FlockEvaluation, evaluate_flocks
from flockenv.sb3.evaluation_callback import FlockEvalCallback
from flockenv.sb3.leader_slot import LeaderSlot
from flockenv.sb3.leader_vec_env import LeaderVecEnv
from flockenv.sb3.monitor import FlockMonitor
from flockenv.sb3.per_flock import PerFlock
from flockenv.sb3.shared_noise import SharedNoisePolicy, shared_noise

__all__ = [
    "FlockEvalCallback",
    "FlockEvaluation",
    "FlockMonitor",
    "LeaderSlot",
    "LeaderVecEnv",
    "PerFlock",
    "SharedNoisePolicy",
    "evaluate_flocks",
    "shared_noise",
]
