"""Results of a training: its learning curve, and a comparison of its leaders with the laws."""

from pathlib import Path
from typing import TYPE_CHECKING

from stable_baselines3.common.monitor import load_results

from flockenv.comparison import compare_leaders
from flockenv.policies.names import PAPERS_LAW, TUNED_LAW
from flockenv.training.ppo.settings import TrainingSettings

if TYPE_CHECKING:
    import pandas as pd
    from stable_baselines3.common.base_class import BaseAlgorithm

    from flockenv.policies.registry import PolicyLike

_EPISODE_S = 480.0
TRAINED = "trained"
"""Name of the trained leaders in a comparison."""


def episodes_of(folder: Path) -> "pd.DataFrame":
    """Return the episodes of a training as stable-baselines3's ``load_results`` reads them.

    Parameters
    ----------
    folder
        The training's folder: its `FlockMonitor` files hold the ``signed_order``,
        ``worst_overlap_cm`` and ``unsolved`` of each episode.
    """
    return load_results(str(folder))


def learning_curve(folder: Path, decisions_hz: float, points: int = 40) -> "pd.DataFrame":
    """Return the mean signed order of a training's episodes against flock-hours.

    Parameters
    ----------
    folder
        As for `episodes_of`.
    decisions_hz
        Decisions per second, to convert lengths of episodes to hours.
    points
        Number of points, each the mean of equally many episodes.

    Returns
    -------
    pandas.DataFrame
        ``flock_hours`` and ``signed_order``.
    """
    episodes = episodes_of(folder)
    # The column "l" holds the episodes' decisions.
    hours = episodes["l"].cumsum() / decisions_hz / 3600.0
    point_of_episode = (episodes.index * points // max(1, len(episodes))).to_numpy()
    orders = episodes["signed_order"].groupby(point_of_episode).mean()
    curve = orders.to_frame().assign(flock_hours=hours.groupby(point_of_episode).last())
    return curve[["flock_hours", "signed_order"]]


def compare_with_laws(
    model: "BaseAlgorithm", settings: TrainingSettings, episodes: int
) -> "pd.DataFrame":
    """Lead held-out flocks by a trained model and by the laws, and return their orders.

    Parameters
    ----------
    model
        Model of stable-baselines3.
    settings
        The settings that it was trained with.
    episodes
        Number of held-out flocks (`TrainingSettings.held_out`), each led for 8 minutes.

    Returns
    -------
    pandas.DataFrame
        The table of `flockenv.comparison.compare_leaders`.
    """
    policies: dict[str, PolicyLike] = {
        PAPERS_LAW: PAPERS_LAW,
        TUNED_LAW: TUNED_LAW,
        TRAINED: model,
    }
    seeds = range(episodes)
    return compare_leaders(settings.held_out(), [settings.n_leaders], policies, seeds, _EPISODE_S)
