"""Do jams and rotation show hysteresis in a slow loop of the noise c4, and in larger flocks, too?

The rule, written before the runs: flocks at bw = 0 and a wall coverage of 0.35 start rotating at
the strongest noise, go down to the weakest and back. The area of the loop is the mean over the
noises of |m| on the way down minus on the way up. There is hysteresis at a size where its interval
lies above 0.05. It is that of a first-order transition where the area does not shrink with the size
(the slope against log2 n has an interval above -0.05), and a loop four times as slow keeps at least
half of it. A loop whose area is shown to be below 0.05 has none to keep, and none that could
shrink: after the runs both questions were left out, and the slow loops are judged by their area. A
fast loop of a large flock may have one because the flock is slow.
"""

import math

import numpy as np
import pandas as pd

import flockenv
from flockenv.statistics.structure import jam_sizes
from studies.claim import Claims, judging, mean
from studies.flocks import rotating
from studies.picture import COLORS, curve, picture
from studies.study import FIRST_SEED, Options, Row, Study, flock, main
from studies.transition.transition_runs import outer_radius_cm

COVERAGE = 0.35
C4 = tuple(round(0.4 * 2.0 ** (-place / 2.0), 4) for place in range(11))  # rad/s^1.5
BOATS, LEVEL_MIN, SLOW = (100, 200, 400, 800), 20.0, 4
SEEDS = 8
FIRST = 400  # Seeds that no other study of this folder has.


def design() -> list[Row]:
    """Return the loops, those of four times the length after the others."""
    return [
        {"coverage": COVERAGE, "dt_s": 0.1, "n_boats": n, "minutes": minutes, "seed": FIRST + seed}
        for minutes, sizes in ((LEVEL_MIN, BOATS), (SLOW * LEVEL_MIN, BOATS[:3]))
        for n in sizes
        for seed in range(SEEDS)
    ]


def measure(row: Row) -> Row:
    """Return |m| and the share of boats in jams in the second half of each level's time."""
    outer = outer_radius_cm(row["n_boats"], row["coverage"])
    pool, seed = (outer, outer * 97.0 / 180.0), FIRST_SEED + row["seed"]
    found: Row = {}
    boats: flockenv.Flock | None = None
    for way, levels in (("down", C4), ("up", C4[-2::-1])):
        for c4 in levels:
            parameters = flock(row, bw_s=0.0, pool=pool, c4=c4)
            before, boats = boats, flockenv.Flock(parameters, seed)
            if before is None:
                boats = rotating(parameters, seed)
                boats.advance(1.5)  # Into the analysis window.
            else:
                time_s = before.time_s
                boats.set_state(before.pose, before.velocity, time_s, allow_overlap=True)
            cycles = max(1, round(60.0 * row["minutes"] / 20.0))
            samples = []
            for _ in range(cycles):
                boats.advance(20.0)  # Five cycles.
                order = boats.order_parameters()
                sizes = jam_sizes(parameters, boats.pose[None])[0]
                m = order.psi_o * math.sin(order.phi_o)
                samples.append((abs(m), sizes.sum() / row["n_boats"]))
            late = np.array(samples[len(samples) // 2 :])
            found |= {f"m_{way}_{c4:g}": late[:, 0].mean(), f"jams_{way}_{c4:g}": late[:, 1].mean()}
            both = (late[:, 0] >= 0.3) & (late[:, 1] >= 0.2)
            found[f"both_{way}_{c4:g}"] = both.mean()
    return found


STUDY = Study("transition/hysteresis", design, measure, lambda row: row["n_boats"] == 100)


def area(runs: pd.DataFrame) -> np.ndarray:
    """Return the area of each run's loop."""
    return np.mean([runs[f"m_down_{c4:g}"] - runs[f"m_up_{c4:g}"] for c4 in C4[:-1]], axis=0)


def judge(table: pd.DataFrame) -> Claims:
    """Judge the rule."""
    claims = Claims(
        "5.2, left open", f"leapfrog, white, dt = 0.1 s, coverage {COVERAGE:g}, bw = 0", ours=True
    )
    for (minutes, n), runs in table.groupby(["minutes", "n_boats"]):
        quantity = f"area of the loop in c4 in |m|, {minutes:g} min per noise"
        claims.add("There is hysteresis", quantity, mean(area(runs)), least=0.05, n=f"{n:g}")
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw |m| and the share in jams on both ways, a panel for each size."""
    fast = table[table["minutes"] == table["minutes"].min()]
    with picture(options, "hysteresis", height_cm=8.0) as figure:
        sizes = sorted(fast["n_boats"].unique())
        panels = figure.subplots(2, len(sizes), sharex=True, sharey=True, squeeze=False)
        for column, n in zip(panels.T, sizes, strict=True):
            runs = fast[fast["n_boats"] == n]
            column[0].set_title(f"n = {n:g} ({len(runs)} runs)")
            for axes, name in zip(column, ("m", "jams"), strict=True):
                for color, way in zip(COLORS, ("down", "up"), strict=False):
                    levels = C4 if way == "down" else C4[:-1]
                    found = [mean(runs[f"{name}_{way}_{c4:g}"]) for c4 in levels]
                    curve(axes, levels, found, color=color, label=f"noise goes {way}")
                axes.set(xscale="log", ylim=(-0.03, 1.03), xticks=C4[::4], xticklabels=C4[::4])
                axes.minorticks_off()
            column[1].set_xlabel("c4 (rad/s^1.5)")
        panels[0, 0].set_ylabel("|m|")
        panels[1, 0].set_ylabel("share in jams")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)


script = judging("hysteresis", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
