"""Figure 14: the density of φ_o against noise, n = 20 and 50, without and with leaders."""

import numpy as np
import pandas as pd

from studies.claim import Claims, Interval, mean
from studies.order import PHI_EDGES, histograms
from studies.picture import PAPERS_LINE, density_map, picture
from studies.section5.section5 import LOST_S, LOW_S, SERIES, Evidence, judging_presets, panel_title
from studies.study import Options, main


def in_rarer_direction(runs: pd.DataFrame) -> tuple[int, int]:
    """Return how many seeds have a run that rotates mostly in the rarer direction, of how many."""
    seeds = [(runs[way] > 0.5).groupby(runs["seed"]).any().sum() for way in ("cw", "ccw")]
    return min(seeds), runs["seed"].nunique()


def clockwise(runs: pd.DataFrame) -> Interval:
    """Return the share of clockwise frames among rotating ones, over seeds with some."""
    ways = runs.groupby("seed")[["cw", "ccw"]].sum()
    ways = ways[ways.sum(axis=1) > 0]
    return mean(ways["cw"] / ways.sum(axis=1))


def judge(e: Evidence) -> Claims:
    """Judge what the paper says of figure 14."""
    claims = Claims("5.2", e.name)
    low = f"k = 0, bw ≤ {LOW_S:g} s"
    free = e.of(20, 0)
    if len(free):
        claims.add(
            "Ordered motion at low noise",
            f"share of frames in rotation, {low}; read as at least half",
            mean(e.over(20, 0, "rotates", 0.0, LOW_S)),
            least=0.5,
            n="20",
        )
        claims.exists(
            "Without leaders order comes in both directions in simulation",
            "seeds with a run that rotates mostly in the rarer direction, k = 0",
            *in_rarer_direction(free),
            n="20",
        )
        claims.add(
            "20 boats are not jammed often enough to leave a mark",
            f"share of jammed frames, {low}; read as at most 0.05",
            mean(e.over(20, 0, "jammed", 0.0, LOW_S)),
            most=0.05,
            n="20",
        )
    for n in (20, 50):
        ways = clockwise(e.of(n, n // 5))
        if ways.runs:
            claims.add(
                "With leaders order has their direction only",
                "share of clockwise frames among rotating ones, k = 0.2 n, all noises",
                ways,
                least=0.95,
                n=str(n),
            )
    dense = e.over(50, 0, "near_zero", 0.0, LOW_S)
    if len(dense):
        claims.add(
            "50 boats at low noise have a peak of φ_o at zero",
            f"density of φ_o within π/12 of 0 over a uniform one, {low}; read as at least 2",
            mean(12 * dense),
            least=2.0,
            n="50",
        )
    return claims


def draw(options: Options, evidence: list[Evidence]) -> None:
    """Draw the densities of each reading."""
    for e in evidence:
        with picture(options, f"fig14_{e.name}", height_cm=9.0) as figure:
            panels = figure.subplots(2, 2, sharex=True, sharey=True)
            for axes, (n, k) in zip(panels.flat, SERIES, strict=True):
                runs = e.of(n, k)
                groups = runs.groupby("bw_s")["phi_histogram"]
                found = [histograms(each) for _, each in groups]
                image = density_map(axes, list(groups.groups), PHI_EDGES, found, 8.0)
                for bw_s in LOST_S:
                    axes.axvline(bw_s, **PAPERS_LINE)
                axes.set(title=panel_title(n, k, runs), yticks=[-np.pi / 2, 0, np.pi / 2])
                axes.set_yticklabels(["−π/2", "0", "π/2"])
            label = "bw (s); the paper's flocks lose their order between the dashed lines"
            figure.supxlabel(label)
            for axes in panels[:, 0]:
                axes.set_ylabel("φ_o")
            figure.colorbar(image, ax=panels, label="density over uniform", extend="max")


script = judging_presets("fig14", judge, draw)

if __name__ == "__main__":
    main(script)
