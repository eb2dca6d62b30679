"""Figure 9: the density of φ_o against noise, without leaders and with three of them."""

import numpy as np
import pandas as pd

from studies.claim import Claims, bca, critical_bw, fall, judging, mean
from studies.section4.section4 import (
    CCW,
    CW,
    FREE,
    LOW_S,
    READING,
    SETUPS,
    STUDY,
    at,
    over,
    setup,
    within,
    words,
)
from studies.study import PHI_EDGES, Options, density_map, histograms, main, picture


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the paper says of figure 9."""
    claims = Claims("4.3", READING)
    by = {name: setup(table, name) for name in SETUPS}
    free = by[FREE]
    for name in SETUPS:
        runs = by[name]
        high = within(runs, 2.1)
        claims.add(
            "φ_o is close to uniform at high noise",
            f"largest over mean density of φ_o in 36 bins, bw > 2 s, {name}; read as at most 1.5",
            bca(
                [np.array([histograms(each["phi_histogram"]) for _, each in high.groupby("seed")])],
                lambda drawn: drawn.mean(-2).max(-1) / drawn.mean(-2).mean(-1),
            ),
            most=1.5,
        )
        lost = ("1.4 s without", 1.2, 1.6) if name == FREE else ("2.0 s with 3", 1.8, 2.2)
        claims.add(
            f"Order is lost around bw = {lost[0]} leaders",
            f"critical bw (s), {name}",
            critical_bw(sorted(runs["bw_s"].unique()), at(runs, "psi_o", "abs_m")),
            least=lost[1],
            most=lost[2],
        )
    for name, way in ((CCW, "ccw"), (CW, "cw")):
        ways = by[name].groupby("seed")[["cw", "ccw"]].sum()
        ways = ways[ways.sum(axis=1) > 0]
        claims.add(
            "Leaders order the flock in their direction only",
            f"share of frames in rotation that go {way}, all noises, {name}",
            mean(ways[way] / ways.sum(axis=1)),
            least=0.95,
        )
    middle = within(free, 0.8, 1.4)
    seeds = {way: (middle[way] > 0.5).groupby(middle["seed"]).any() for way in ("cw", "ccw")}
    claims.exists(
        "Without leaders order comes in both directions",
        "seeds with a run that rotates mostly in the rarer direction, bw 0.8 to 1.4 s",
        min(each.sum() for each in seeds.values()),
        middle["seed"].nunique(),
    )
    noises = sorted(free["bw_s"].unique())
    claims.add(
        "Leaders increase the critical noise",
        "critical bw with 3 clockwise leaders minus without (s)",
        bca(
            [*at(by[CW], "psi_o", "abs_m"), *at(free, "psi_o", "abs_m")],
            lambda *drawn: fall(noises, drawn[: len(noises)]) - fall(noises, drawn[len(noises) :]),
        ),
        least=0.0,
    )
    low = within(free, *LOW_S)
    jammed = (low["jammed"] > 0.05).groupby(low["seed"]).any()
    claims.exists(
        "Jamming is present occasionally at low noise",
        f"seeds with a run jammed in more than 5 % of its frames, {words(LOW_S)}, no leaders",
        jammed.sum(),
        len(jammed),
    )
    claims.add(
        "Jamming comes mainly without leaders",
        f"share of jammed frames at {words(LOW_S)}, without leaders minus with 3",
        mean(over(free, "jammed", *LOW_S) - over(by[CW], "jammed", *LOW_S)),
        least=0.0,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the densities."""
    noises = sorted(table["bw_s"].unique())
    with picture(options, "fig09", height_cm=6.0) as figure:
        panels = figure.subplots(1, 3, sharey=True)
        for axes, name in zip(panels, SETUPS, strict=True):
            runs = setup(table, name)
            found = [histograms(runs.loc[runs["bw_s"] == b, "phi_histogram"]) for b in noises]
            image = density_map(axes, noises, PHI_EDGES, found, 6.0)
            axes.set_title(f"{name} ({len(runs) // len(noises)} runs each)")
            axes.set(xlabel="bw (s)", yticks=[-np.pi / 2, 0, np.pi / 2])
            axes.set_yticklabels(["−π/2", "0", "π/2"])
        panels[0].set_ylabel("φ_o")
        figure.colorbar(image, ax=list(panels), label="density over uniform", extend="max")


script = judging("fig09", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
