"""PPO of stable-baselines3 with one policy shared by all leaders.

Needs the extra ``train``.
"""

from flockenv._io.extras import require

require("stable_baselines3", "train")

# ruff: noqa: E402 - after the check above
from flockenv.training.ppo.curve import TRAINED, compare_with_laws, episodes_of, learning_curve
from flockenv.training.ppo.run import (
    CHECKPOINT,
    MODEL,
    Progress,
    TrainingError,
    resume,
    stored_settings,
    train,
)
from flockenv.training.ppo.settings import TrainingSettings

__all__ = [
    "CHECKPOINT",
    "MODEL",
    "TRAINED",
    "Progress",
    "TrainingError",
    "TrainingSettings",
    "compare_with_laws",
    "episodes_of",
    "learning_curve",
    "resume",
    "stored_settings",
    "train",
]
