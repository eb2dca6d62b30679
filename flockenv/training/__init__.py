"""Training of leaders: PPO of stable-baselines3 with one policy shared by all of them.

Needs the extra ``train``.
"""

from flockenv._io.extras import require

require("stable_baselines3", "train")

# ruff: noqa: E402 - after the check above
from flockenv.learning_curve import draw_curve
from flockenv.training.curve import TRAINED, compare_with_laws, learning_curve
from flockenv.training.run import (
    CHECKPOINT,
    MODEL,
    Progress,
    TrainingError,
    resume,
    stored_settings,
    train,
)
from flockenv.training.settings import TrainingSettings

__all__ = [
    "CHECKPOINT",
    "MODEL",
    "TRAINED",
    "Progress",
    "TrainingError",
    "TrainingSettings",
    "compare_with_laws",
    "draw_curve",
    "learning_curve",
    "resume",
    "stored_settings",
    "train",
]
