"""Results of a training: its learning curve, and its leaders beside the laws."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from stable_baselines3.common.monitor import load_results

from flockenv._io.atomic_write import atomic_write
from flockenv._io.extras import require
from flockenv.comparison import compare_leaders
from flockenv.policies.names import PAPERS_LAW, TUNED_LAW
from flockenv.training.settings import TrainingSettings

if TYPE_CHECKING:
    import pandas as pd

_EPISODE_S = 480.0
TRAINED = "trained"
"""The name of the trained leaders in the comparison."""


def learning_curve(folder: Path, decisions_hz: float, points: int = 40) -> "pd.DataFrame":
    """Return the mean signed order of a training's episodes against flock-hours.

    Parameters
    ----------
    folder
        Of a `FlockMonitor`'s file with the ``signed_order`` of each episode.
    decisions_hz
        Decisions per second, which turns lengths of episodes into hours.
    points
        Number of means, each of equally many episodes.

    Returns
    -------
    pandas.DataFrame
        ``flock_hours`` and ``signed_order``.
    """
    episodes = load_results(str(folder))
    hours = episodes["l"].cumsum() / decisions_hz / 3600.0
    group = (episodes.index * points // max(1, len(episodes))).to_numpy()
    order = episodes["signed_order"].groupby(group).mean()
    return order.to_frame().assign(flock_hours=hours.groupby(group).last())[
        ["flock_hours", "signed_order"]
    ]


def draw_curve(curve: "pd.DataFrame", laws: dict[str, float], path: Path) -> None:
    """Draw a learning curve, with the laws' orders as level lines.

    Parameters
    ----------
    curve
        As of `learning_curve`.
    laws
        Mean signed order by the name of a law.
    path
        Of a PNG file.
    """
    figure: Any = require("matplotlib.figure", "plot").Figure((6.4, 3.6), layout="constrained")
    axes = figure.subplots()
    axes.plot(curve["flock_hours"], curve["signed_order"], label="leaders that explore")
    for (name, order), style in zip(laws.items(), ("--", ":", "-.", "-"), strict=False):
        axes.axhline(order, color="0.4", lw=1, ls=style, label=name)
    axes.set(xlabel="simulated time of all flocks (hours)", ylabel="mean signed order")
    axes.legend(frameon=False, fontsize=8)
    with atomic_write(path) as file:
        figure.savefig(file, dpi=150, format="png")


def compare_with_laws(model: Any, settings: TrainingSettings, episodes: int) -> "pd.DataFrame":
    """Return the orders that a model and the laws reach in held-out flocks of its training.

    Parameters
    ----------
    model
        Of stable-baselines3.
    settings
        What it was trained with.
    episodes
        Number of flocks, each led for 8 minutes (`TrainingSettings.held_out`).

    Returns
    -------
    pandas.DataFrame
        As of `flockenv.comparison.compare_leaders`.
    """
    policies = {
        PAPERS_LAW: PAPERS_LAW,
        TUNED_LAW: TUNED_LAW,
        TRAINED: model,
    }
    seeds = range(episodes)
    return compare_leaders(settings.held_out(), [settings.n_leaders], policies, seeds, _EPISODE_S)
