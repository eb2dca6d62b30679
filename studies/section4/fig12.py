"""Figure 12: Ψ_o against the number of leaders."""

import numpy as np
import pandas as pd

from studies.claim import Claims, Interval, bca, judging, mean
from studies.order import order_row
from studies.picture import COLORS, curve, picture
from studies.section4.fig08 import slope
from studies.section4.section4 import READING
from studies.study import SEEDS, Options, Row, Study, main, simulated

NOISES_S = (1.8, 1.4)
"""The paper's noise, which it calls critical, and about the critical one of the preset."""


def design() -> list[Row]:
    """Return runs of 8 minutes with 0 to 4 clockwise leaders."""
    return [
        {"preset": "experiment", "n_leaders": k, "bw_s": bw_s, "minutes": 8.0, "seed": seed}
        for seed in range(SEEDS)
        for bw_s in NOISES_S
        for k in range(5)
    ]


STUDY = Study("section4/leader_count", design, lambda row: order_row(simulated(row)))


def per_leader(runs: pd.DataFrame) -> Interval:
    """Return by how much mean Ψ_o grows with each leader."""
    leaders = sorted(runs["n_leaders"].unique())
    groups = [each[["psi_o"]] for _, each in runs.groupby("n_leaders")]
    return bca(groups, lambda *drawn: slope(leaders, [g[..., 0].mean(-1) for g in drawn]))


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the paper says of figure 12."""
    claims = Claims("4.4", READING)
    for bw_s in NOISES_S:
        runs = table[np.isclose(table["bw_s"], bw_s)]
        claims.add(
            "Order increases with the number of leaders",
            f"slope of mean Ψ_o against 0 to 4 leaders, bw = {bw_s:g} s",
            per_leader(runs),
            least=0.0,
            ours=bw_s != NOISES_S[0],
        )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw each run and the means."""
    with picture(options, "fig12", width_cm=12.0, height_cm=6.0) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, color, bw_s in zip(panels, COLORS, NOISES_S, strict=False):
            runs = table[np.isclose(table["bw_s"], bw_s)]
            axes.plot(runs["n_leaders"], runs["psi_o"], ".", color="0.7", markersize=2)
            groups = runs.groupby("n_leaders")["psi_o"]
            curve(axes, groups.groups, [mean(each) for _, each in groups], color=color)
            axes.set(xlabel="leaders", ylim=(0, 1))
            paper = "\nthe paper's rises, p = 0.002" if bw_s == NOISES_S[0] else "\n"
            axes.set_title(f"bw = {bw_s:g} s ({runs['seed'].nunique()} runs each){paper}")
        panels[0].set_ylabel("mean Ψ_o")


script = judging("fig12", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
