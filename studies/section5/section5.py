"""The runs of Section 5 in every reading: scheme, noise, tolerance, dt and pool are axes."""

from collections.abc import Callable
from typing import Any

import pandas as pd

from studies.claim import Claim, Claims, Interval, critical_bw, judging, mean, unknown
from studies.order import order_row
from studies.picture import COLORS, curve, picture
from studies.study import SEEDS, Options, Row, Study, simulated

LEVELS_S = tuple(round(0.1 * place, 1) for place in range(13))
FEW_LEVELS_S = (0.0, 0.2, *LEVELS_S[4:9], 1.0, 1.2)
LOW_S, HIGH_S = 0.2, 1.0  # The most that is low noise, and the least that is disorder.

_LEAPFROG: Row = {"scheme": "leapfrog", "noise_scheme": "white", "overlap_tolerance_cm": 0.01}
_PAPER: Row = {"scheme": "paper", "noise_scheme": "per-step", "overlap_tolerance_cm": 0.01}
READINGS: dict[str, Row] = {
    name: {"pool": "wide", "dt_s": 0.02} | row
    for name, row in {
        "simulation": _LEAPFROG,
        "paper": _PAPER,
        "paper, 0.001 cm": _PAPER | {"overlap_tolerance_cm": 0.001},
        "paper, 0.1 cm": _PAPER | {"overlap_tolerance_cm": 0.1},
        "paper, white": _PAPER | {"noise_scheme": "white"},
        "leapfrog, per-step": _LEAPFROG | {"noise_scheme": "per-step"},
        "paper, narrow": _PAPER | {"pool": "narrow"},
        "simulation, narrow": _LEAPFROG | {"pool": "narrow"},
        "paper, 0.003 cm": _PAPER | {"overlap_tolerance_cm": 0.003},
        "paper, 0.03 cm": _PAPER | {"overlap_tolerance_cm": 0.03},
        "paper, white, 0.001 cm": _PAPER | {"noise_scheme": "white", "overlap_tolerance_cm": 0.001},
        "paper, white, 0.1 cm": _PAPER | {"noise_scheme": "white", "overlap_tolerance_cm": 0.1},
        "paper, dt 0.01 s": _PAPER | {"dt_s": 0.01},
        "paper, dt 0.05 s": _PAPER | {"dt_s": 0.05},
        "simulation, dt 0.1 s": _LEAPFROG | {"dt_s": 0.1},
        "moreau, per-step": _LEAPFROG | {"scheme": "moreau", "noise_scheme": "per-step"},
    }.items()
}
"""Readings by name, the most decisive first. Tolerance counts in the scheme `paper` alone."""


def in_words(name: str) -> str:
    """Return a reading's scheme and noise, and its overlap, step and pool if they are others."""
    row, usual = READINGS[name], READINGS["simulation"]
    words = ["literal scheme" if row["scheme"] == "paper" else str(row["scheme"])]
    words.append("white noise" if row["noise_scheme"] == "white" else "noise per step")
    others = {
        "overlap_tolerance_cm": f"overlap {row['overlap_tolerance_cm']} cm",
        "dt_s": f"steps of {row['dt_s']} s",
        "pool": f"pool {row['pool']}",
    }
    return ", ".join([*words, *(text for key, text in others.items() if row[key] != usual[key])])


LOST_S = (0.6, 0.8)
"""Backward durations between which the paper's simulated flocks lose their order."""

SERIES = [(n, k) for n in (20, 50) for k in (0, n // 5)]
"""Numbers of boats and of leaders: the four panels of figures 14 to 16."""
PRESETS = ("simulation", "paper")
_DENSITIES = (20, 23, 26, 29, 32, 35, 38, 41, 44, 47, 50)
_FEW_DENSITIES = (20, 30, 40, 50)


def design() -> list[Row]:
    """Return the presets at every noise and density and the other readings at fewer."""
    rows: list[Row] = []
    for name, reading in READINGS.items():
        dense = name in PRESETS
        noises = LEVELS_S if dense else FEW_LEVELS_S
        points = [(n, k, b) for n, k in SERIES for b in noises]
        points += [(n, 0, 0.0) for n in (_DENSITIES if dense else _FEW_DENSITIES) if 20 < n < 50]
        rows += [
            {**reading, "n_boats": n, "n_leaders": k, "bw_s": b, "minutes": 30.0, "seed": seed}
            for n, k, b in points
            for seed in range(SEEDS)
        ]
    return rows


def measure(row: Row) -> Row:
    """Return the order of a run after its first three minutes."""
    return order_row(simulated(row, sample_hz=4.0))


STUDY = Study(
    "section5/section5", design, measure, lambda row: row["bw_s"] in (0.0, 0.2, 0.6, 1.0, 1.2)
)


class Evidence:
    """The runs of a reading, by number of boats and of leaders."""

    def __init__(self, table: pd.DataFrame, name: str) -> None:
        found = table
        for column, value in READINGS[name].items():
            found = found[found[column] == value]
        self.name, self.runs = name, found.assign(rotates=found["cw"] + found["ccw"])

    def of(self, n: int, k: int, least: float = 0.0, most: float = 9.0) -> pd.DataFrame:
        """Return the runs of a series at the noises of a range that have all of its seeds.

        A series counts once it has been run at four noises.
        """
        r = self.runs
        chosen = r[(r["n_boats"] == n) & (r["n_leaders"] == k)]
        count = chosen.groupby("bw_s")["seed"].transform("size")
        chosen = chosen[count == count.max()]
        enough = chosen["bw_s"].nunique() >= 4
        return chosen[enough & chosen["bw_s"].between(least - 1e-9, most + 1e-9)]

    def over(self, n: int, k: int, column: str, least: float, most: float = 9.0) -> Any:
        """Return the mean of a column over the noises of a range, one value per seed."""
        return self.of(n, k, least, most).groupby("seed")[column].mean().to_numpy()

    def groups(self, n: int, k: int, *columns: str) -> list[Any]:
        """Return arrays of shape (runs, columns), one per noise."""
        return [each[list(columns)].to_numpy() for _, each in self.of(n, k).groupby("bw_s")]

    def critical(self, n: int, k: int) -> Interval:
        """Return the bw at which order is lost; NaN where it was not measured up to disorder."""
        noises = sorted(self.of(n, k)["bw_s"].unique())
        if len(noises) < 4 or noises[-1] < HIGH_S:
            return unknown()
        return critical_bw(noises, self.groups(n, k, "psi_o", "abs_m"))


def judging_presets(
    figure: str,
    judge: Callable[[Evidence], Claims],
    draw: Callable[[Options, list[Evidence]], None],
) -> Callable[[Options], None]:
    """Return the script of a figure that judges and draws the runs of both presets."""

    def evidence(table: pd.DataFrame) -> list[Evidence]:
        return [Evidence(table, name) for name in PRESETS]

    def claims(table: pd.DataFrame) -> list[Claim]:
        return [claim for e in evidence(table) for claim in judge(e)]

    claims.__module__ = judge.__module__
    return judging(figure, STUDY, claims, lambda options, table: draw(options, evidence(table)))


def draw_means(
    options: Options, evidence: list[Evidence], name: str, column: str, label: str
) -> None:
    """Draw the means of a column against noise with their intervals, a panel per series."""
    with picture(options, name, height_cm=9.0) as figure:
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for axes, (n, k) in zip(panels.flat, SERIES, strict=True):
            for color, marker, e in zip(COLORS, "os", evidence, strict=False):
                runs = e.of(n, k)
                groups = runs.groupby("bw_s")[column]
                found = [mean(each) for _, each in groups]
                curve(axes, groups.groups, found, color=color, marker=marker, label=e.name)
                axes.set_title(panel_title(n, k, runs))
            axes.axvspan(*LOST_S, color="0.9", zorder=0)
        for axes in panels[1]:
            axes.set_xlabel("bw (s); shaded: where the paper has order lost")
        for axes in panels[:, 0]:
            axes.set_ylabel(label)
        panels[0, 0].legend(title="preset")


def panel_title(n: int, k: int, runs: pd.DataFrame) -> str:
    """Return what a panel says of its runs."""
    return f"n = {n}, k = {k} ({runs.groupby('bw_s').size().max()} runs each)"
