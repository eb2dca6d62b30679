"""Do sparse flocks rotate without noise? There are two noises: bw is 0 here, and c4 varies.

Written before the runs, but for their number: 12 flocks of 16 minutes from a random start, at c4
from 0 to the preset's. (24 were planned; their time ended after the first twelve seeds.)
A flock is said to jam if the interval of the mean share of jammed frames lies above a half, and to
rotate if that of mean |m| does. Noise c4 makes motion where mean |m| grows with log c4 with its
whole interval. c4 = 0.0141 rad/s^1.5 is as strong as the literal noise of Table 3 at dt = 0.02 s.
With the scheme `paper` c4 is that of the literal noise, in rad/s².
"""

import math

import pandas as pd

from studies.claim import Claims, bca, judging, mean
from studies.order import order_row
from studies.picture import COLORS, curve, picture
from studies.section4.fig08 import slope
from studies.study import Options, Row, Study, main
from studies.study import simulated as run_of

FIRST, RUNS = 500, 12  # Seeds that no other study of this folder has.
C4 = (0.0, 0.0141, 0.03, 0.05, 0.1)
FLOCKS = (
    ("simulation", "wide", 20),
    ("simulation", "wide", 27),
    ("simulation", "wide", 50),
    ("simulation", "narrow", 27),
    ("paper", "wide", 20),
    ("paper", "wide", 50),
)


def design() -> list[Row]:
    """Return runs without leaders and without backing, seed by seed."""
    return [
        {"preset": preset, "pool": pool, "n_boats": n, "n_leaders": 0, "bw_s": 0.0, "c4": c4}
        | {"minutes": 16.0, "seed": seed}
        for seed in range(FIRST, FIRST + RUNS)
        for preset, pool, n in FLOCKS
        for c4 in C4
    ]


def measure(row: Row) -> Row:
    """Return order and jams of a run."""
    found = order_row(run_of(row, sample_hz=4.0))
    return {name: found[name] for name in ("psi_o", "abs_m", "jammed")}


STUDY = Study("density/quiet", design, measure, lambda row: row["n_boats"] == 20)


def judge(table: pd.DataFrame) -> Claims:
    """Judge each flock, and whether c4 makes it rotate."""
    claims = Claims("6", "", ours=True)
    for (preset, pool, n), runs in table.groupby(["preset", "pool", "n_boats"], sort=False):
        claims.reading = f"{preset}, {pool}"
        levels = dict(iter(runs.groupby("c4")))
        for c4, own in levels.items():
            where = f"bw = 0, c4 = {c4:g}, no leaders"
            jams, m = mean(own["jammed"]), mean(own["abs_m"])
            claims.add(
                "Flocks jam", f"share of jammed frames, {where}", jams, least=0.5, n=f"{n:g}"
            )
            claims.add("Flocks rotate", f"mean |m|, {where}", m, least=0.5, n=f"{n:g}")
        some = {c4: own[["abs_m"]].to_numpy() for c4, own in levels.items() if c4}
        x = [math.log(c4) for c4 in some]
        claims.add(
            "The noise c4 makes motion",
            "slope of mean |m| against ln c4, c4 = 0.0141 to 0.1, bw = 0",
            bca([*some.values()], lambda *d, x=x: slope(x, [g[..., 0].mean(-1) for g in d])),
            least=0.0,
            n=f"{n:g}",
        )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw |m| and the share of jammed frames against c4."""
    with picture(options, "quiet", height_cm=7.5) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        flocks = table.groupby(["preset", "pool", "n_boats"], sort=False)
        for color, ((preset, pool, n), runs) in zip(COLORS, flocks, strict=False):
            scheme = "literal scheme" if preset == "paper" else "default scheme"
            style = {"color": color, "label": f"{n:g} in {pool}, {scheme}"}
            style["marker"] = "s" if preset == "paper" else "o"
            for axes, column in ((left, "abs_m"), (right, "jammed")):
                groups = runs.groupby("c4")[column]
                curve(axes, groups.groups, [mean(each) for _, each in groups], **style)
        left.set(ylabel="mean |m|", xlabel="noise c4", ylim=(-0.03, 1.03))
        right.set(ylabel="share of jammed frames", xlabel="noise c4")
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)


script = judging("quiet", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
