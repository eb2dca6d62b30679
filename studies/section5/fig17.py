"""Figure 17: densities of Ψ_o and φ_o against the number of boats, without noise and leaders."""

import numpy as np
import pandas as pd

from studies.claim import Claims, bca, mean
from studies.order import MOSTLY, PHI_EDGES, PSI_EDGES, histograms
from studies.picture import density_map, picture
from studies.section5.section5 import Evidence, judging_presets
from studies.study import Options, main


def densities(e: Evidence) -> pd.DataFrame:
    """Return the runs at bw = 0 without leaders."""
    r = e.runs
    return r[(r["bw_s"] == 0.0) & (r["n_leaders"] == 0)]


def in_rarer_state(runs: pd.DataFrame) -> tuple[float, int, int]:
    """Return the n at which most runs are in the rarer state, how many are, and of how many."""
    is_jam = (runs["jammed"] >= MOSTLY).groupby(runs["n_boats"]).sum()
    is_rotation = (runs["rotates"] >= MOSTLY).groupby(runs["n_boats"]).sum()
    rarer = np.minimum(is_jam, is_rotation)
    n = rarer.idxmax()
    return n, rarer.max(), (runs["n_boats"] == n).sum()


def judge(e: Evidence) -> Claims:
    """Judge what the paper says of figure 17."""
    claims = Claims("5.2", e.name)
    runs = densities(e)
    sizes = runs["n_boats"].unique()
    if not {20, 50} <= set(sizes):
        return claims
    few, many = (runs[runs["n_boats"] == n] for n in (20, 50))
    claims.add(
        "Between 20 and 50 boats order gives way to jamming",
        "share of jammed frames, n = 50 minus n = 20, bw = 0; read as at least 0.3",
        bca(
            [many[["jammed"]], few[["jammed"]]],
            lambda dense, sparse: dense[..., 0].mean(-1) - sparse[..., 0].mean(-1),
        ),
        least=0.3,
        n="20, 50",
    )
    if len(sizes) < 4:
        return claims
    between = 1.0 - runs["jammed"] - runs["rotates"]
    claims.add(
        "The jamming–order transition is sharp",
        "share of frames neither jammed nor rotating, all n, bw = 0; read as at most 0.2",
        mean(between.groupby(runs["seed"]).mean()),
        most=0.2,
        n="20 to 50",
    )
    n, count, of = in_rarer_state(runs)
    claims.exists(
        "Jam and rotation both come from random starts at one n",
        "runs in the rarer of jam and rotation (70 % of a run) at the n where most are, bw = 0",
        count,
        of,
        n=f"{n:g}",
    )
    return claims


def draw(options: Options, evidence: list[Evidence]) -> None:
    """Draw the densities of both presets."""
    with picture(options, "fig17", height_cm=9.0) as figure:
        panels = figure.subplots(2, 2, sharex=True)
        for (top, bottom), e in zip(panels.T, evidence, strict=True):
            runs = densities(e)
            groups = runs.groupby("n_boats")
            for axes, column, edges, most in (
                (top, "psi_histogram", PSI_EDGES, 8.0),
                (bottom, "phi_histogram", PHI_EDGES, 8.0),
            ):
                found = [histograms(each[column]) for _, each in groups]
                image = density_map(axes, list(groups.groups), edges, found, most)
            top.set_title(f"{e.name}, bw = 0 ({groups.size().min()} runs each)")
            bottom.set(xlabel="number of boats n", yticks=[-np.pi / 2, 0, np.pi / 2])
            bottom.set_yticklabels(["−π/2", "0", "π/2"])
        panels[0, 0].set_ylabel("Ψ_o")
        panels[1, 0].set_ylabel("φ_o")
        figure.colorbar(image, ax=panels, label="density over uniform", extend="max")


script = judging_presets("fig17", judge, draw)

if __name__ == "__main__":
    main(script)
