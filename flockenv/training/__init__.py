"""Training of leaders: PPO with one policy shared by all of them.

Needs the extra ``train``: ``pip install flockenv[train]``.
"""

# First: it says what to install where stable-baselines3 and torch are missing.
import flockenv.training.actor  # noqa: F401
from flockenv.policies.laws import LAWS
from flockenv.training.checkpoint import Progress
from flockenv.training.cloning import clone_law
from flockenv.training.ppo import TrainingResult, resume, stored_settings, train
from flockenv.training.rollback_point import with_flock_hours
from flockenv.training.seeds import SeedsResult, train_seeds
from flockenv.training.settings import TrainingError, TrainingSettings

__all__ = [
    "LAWS",
    "Progress",
    "SeedsResult",
    "TrainingError",
    "TrainingResult",
    "TrainingSettings",
    "clone_law",
    "resume",
    "stored_settings",
    "train",
    "train_seeds",
    "with_flock_hours",
]
