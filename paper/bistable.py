"""Is the jamming–order transition bistable? Flocks of 20 to 50 boats from a jam and from rotation.

Bistable are flocks of which, at one number of boats, both states come from either start: of the
runs that start in one jam some stay jammed and some come to rotate, and likewise of those that
start rotating. Written before the runs. Larger flocks are followed in `transition.py`.
"""

import numpy as np
import pandas as pd
from claim import Claims, judging, mean
from section5 import PRESETS, READINGS
from starts import one_jam, rotating
from study import (
    COLORS,
    MOSTLY,
    SEEDS,
    Options,
    Row,
    Study,
    curve,
    flock,
    main,
    order_row,
    picture,
    seed_of,
)

import flockenv

BOATS = (20, 23, 26, 29, 32, 35, 41, 50)
STARTS = {"one-jam": one_jam, "rotating": rotating}
STATES = ("jammed", "rotates")


def design() -> list[Row]:
    """Return runs of 30 minutes without noise and leaders, of both presets, from both starts."""
    return [
        {**READINGS[preset], "preset": preset, "n_boats": n, "n_leaders": 0, "bw_s": 0.0}
        | {"start": start, "minutes": 30.0, "seed": seed}
        for n in BOATS
        for preset in PRESETS
        for start in STARTS
        for seed in range(SEEDS)
    ]


def measure(row: Row) -> Row:
    """Return the shares of frames in a jam and in rotation after the first tenth of a run."""
    parameters, seed = flock(row), seed_of(row)
    start = STARTS[row["start"]](parameters, seed).snapshot()
    run = flockenv.simulate(
        parameters, seed, 60.0 * row["minutes"], 4.0, dtype=np.float32, start=start
    )
    found = order_row(run)
    return {"jammed": found["jammed"], "rotates": found["cw"] + found["ccw"]}


STUDY = Study("bistable", design, measure, lambda row: row["n_boats"] in (20, 29, 50))


def judge(table: pd.DataFrame) -> Claims:
    """Judge whether both states come from either start, at the n where the rarest is least rare."""
    claims = Claims("5.2", "")
    for preset, runs in table.groupby("preset", sort=False):
        claims.reading = str(preset)
        counts = pd.DataFrame(
            {
                (start, state): (each[state] >= MOSTLY).groupby(each["n_boats"]).sum()
                for start, each in runs.groupby("start")
                for state in STATES
            }
        )
        n = counts.min(axis=1).idxmax()
        start, state = counts.loc[n].idxmin()
        claims.exists(
            "The jamming–order transition is bistable",
            f"runs of the rarest of both states from either start ({state} from {start}), bw = 0",
            counts.loc[n, (start, state)],
            len(runs[(runs["n_boats"] == n) & (runs["start"] == start)]),
            n=f"{n:g}",
        )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the share of runs that are mostly in each state against the number of boats."""
    with picture(options, "bistable", height_cm=6.0) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, preset in zip(panels, PRESETS, strict=True):
            for color, start in zip(COLORS, STARTS, strict=False):
                runs = table[(table["preset"] == preset) & (table["start"] == start)]
                for marker, state in zip("so", STATES, strict=True):
                    shares = (runs[state] >= MOSTLY).groupby(runs["n_boats"])
                    found = [mean(each.astype(float)) for _, each in shares]
                    style = {"color": color, "marker": marker, "linewidth": 0.6}
                    if found:
                        word = "rotates" if state == "rotates" else "jammed"
                        curve(axes, shares.groups, found, **style, label=f"{word}, from {start}")
            axes.set(xlabel="number of boats n", title=f"{preset}, bw = 0")
        panels[0].set(ylabel="share of runs", ylim=(-0.03, 1.03))
        panels[1].legend()


script = judging("bistable", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
