"""What single boats and pairs of boats do: displacement, persistence, distances, the wall."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from numpy.typing import NDArray

from flockenv.recording import Recording
from flockenv.reproduce.experiment.state_figures import (
    LEVELS_S,
    pose_points,
    pose_runs,
)
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.statistics import structure
from flockenv.statistics.intervals import CONFIDENCE, interval, mean_replicates

__all__ = ["REPRODUCTIONS"]

_EDGES_CM = np.arange(8.0, 62.0, 2.0)
_LAGS_S = np.array([0.2, 0.6, 1, 2, 4, 7, 10, 15, 20, 30, 45, 60, 90, 120, 180])


def _motion(settings: Settings, results: Results) -> Outcome:
    lagged, pairs, walls = [], [], []
    for bw_s, specs in pose_points(settings).items():
        runs = [results[spec] for spec in specs]
        lagged.append(_lagged_rows(bw_s, specs[0].sample_hz, runs))
        pairs.append(_pair_rows(bw_s, runs))
        walls.append(_wall_row(bw_s, runs))
    moved, near, wall = pd.concat(lagged), pd.concat(pairs), pd.DataFrame(walls)
    with paper_style():
        picture = column_figure(9.5)
        panels = picture.subplots(2, 2)
        for place, bw_s in enumerate(LEVELS_S[::2]):
            own = moved[moved["bw_s"] == bw_s]
            label, color = f"bw = {bw_s} s", COLORS[place]
            for axes, x, name in (
                (panels[0, 0], "lag_s", "msd_cm2"),
                (panels[0, 1], "lag_s", "heading_correlation"),
            ):
                _band(axes, own, x, name, color, label)
            _band(panels[1, 0], near[near["bw_s"] == bw_s], "distance_cm", "g", color, label)
        panels[0, 0].set(xscale="log", yscale="log")
        panels[0, 1].set(xscale="log")
        panels[1, 1].errorbar(
            wall["bw_s"],
            wall["on_outer_wall"],
            np.maximum(
                [
                    wall["on_outer_wall"] - wall["on_outer_wall_low"],
                    wall["on_outer_wall_high"] - wall["on_outer_wall"],
                ],
                0.0,
            ),
            fmt="o-",
        )
        panels[0, 0].set(xlabel="time (s)", ylabel="mean-square\ndisplacement (cm²)")
        panels[0, 1].set(xlabel="time (s)", ylabel=r"$\langle\cos\Delta\alpha\rangle$")
        panels[0, 1].axhline(np.exp(-1), color="0.6", lw=0.6)
        panels[1, 0].set(xlabel="distance of centers (cm)", ylabel="pairs over\nindependent ones")
        panels[1, 0].axhline(1.0, color="0.6", lw=0.6)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        picture.legend(handles, labels, loc="outside upper center", ncols=2)
        panels[1, 1].set(
            xlabel="backward time bw (s)",
            ylabel="share of boats\non the outer wall",
            ylim=(0, 1),
        )
    notes = [
        "The mean-square displacement and the heading correlation are over boats and starting "
        "times. A heading persists for about as long as the correlation is above 1/e (gray). "
        "Numbers of pairs are divided by those of boats at the same radii with independent polar "
        "angles. A boat is on the wall within 0.5 cm of it.",
        f"Bars and bands are {CONFIDENCE:.0%} intervals of a bootstrap over runs.",
    ]
    tables = {"motion_lagged": moved, "motion_pairs": near, "motion_wall": wall}
    return Outcome(tables, {"motion": picture}, [], notes)


def _lagged_rows(bw_s: float, sample_hz: float, runs: Sequence[Recording]) -> pd.DataFrame:
    lags = [lag for lag in _LAGS_S if lag < runs[0].duration_s]
    samples = [round(lag * sample_hz) for lag in lags]
    squares = [structure.mean_square_displacement(run.pose, samples) for run in runs]
    cosines = [structure.heading_correlation(run.pose, samples) for run in runs]
    columns = {"bw_s": bw_s, "lag_s": lags}
    return pd.DataFrame(
        {**columns, **_over_runs("msd_cm2", squares), **_over_runs("heading_correlation", cosines)}
    )


def _over_runs(name: str, runs: Sequence[NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Return means over runs and the ends of their intervals, as columns."""
    ends = np.array([interval(mean_replicates(values)) for values in np.transpose(runs)])
    return {name: ends[:, 0], f"{name}_low": ends[:, 1], f"{name}_high": ends[:, 2]}


def _band(axes: Axes, table: pd.DataFrame, x: str, y: str, color: str, label: str) -> None:
    axes.fill_between(table[x], table[f"{y}_low"], table[f"{y}_high"], color=color, alpha=0.2, lw=0)
    axes.plot(table[x], table[y], color=color, label=label)


def _pair_rows(bw_s: float, runs: Sequence[Recording]) -> pd.DataFrame:
    found = [structure.pair_distribution(run.analyzed().pose[::3], _EDGES_CM) for run in runs]
    distances = (_EDGES_CM[:-1] + _EDGES_CM[1:]) / 2
    return pd.DataFrame({"bw_s": bw_s, "distance_cm": distances, **_over_runs("g", found)})


def _wall_row(bw_s: float, runs: Sequence[Recording]) -> dict[str, float]:
    means = [structure.on_outer_wall(run.parameters, run.analyzed().pose).mean() for run in runs]
    mean, low, high = interval(mean_replicates(np.array(means)))
    return {
        "bw_s": bw_s,
        "on_outer_wall": mean,
        "on_outer_wall_low": low,
        "on_outer_wall_high": high,
    }


REPRODUCTIONS = (
    Reproduction(
        name="motion",
        title="Single boats, pairs and the wall",
        section="4",
        runs=pose_runs,
        analyze=_motion,
    ),
)
