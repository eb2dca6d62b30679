"""The results in brief: one sentence and one table."""

from __future__ import annotations

import numpy as np
import pandas as pd
from formats import plain, table, times
from measurements import BOX2D, OURS, RAPIER, TIGHT_RAPIER, Measurements, ours, pick


def headline(m: Measurements) -> str:
    """Return the main result in two sentences."""
    settings = m.settings()
    mine, theirs = pick(settings, OURS), pick(settings, RAPIER)
    overlap = theirs.jam_overlap_mean_cm / mine.jam_overlap_mean_cm
    slide = theirs.slide_median_cm / mine.slide_median_cm
    return (
        f"A step of 27 boats at dt = 0.01 s takes {plain(mine.jam_us_per_step)} µs jammed against "
        f"the wall and {plain(mine.cycle_us_per_step)} µs in the fw-nop-bw-nop cycle. This is "
        f"{times(mine.jam_faster)} and {times(mine.cycle_faster)} as fast as rapier2d-f64, with "
        f"{times(overlap)} less overlap and {times(slide)} less error in sliding."
    )


def summary(m: Measurements) -> str:
    """Return the table of the main results."""
    settings = m.settings()
    mine, theirs = pick(settings, OURS), pick(settings, RAPIER)
    tight = pick(settings, TIGHT_RAPIER)
    large = pick(m.speed, OURS, scene="jam", n=1000)
    growth = m.growth.set_index("n")
    most = int(growth.index.max())
    own = m.overlap[(m.overlap.engine == "flockenv") & (m.overlap.solver == "block-pivoting")]
    overlap = mine.jam_overlap_mean_cm
    in_use = growth.bytes_in_use_per_boat - 8 * growth.factor_entries_per_boat
    less = "less overlap than rapier2d-f64 (mean of each step's deepest)"
    rows = [
        ["27 boats, jam: time per step", f"{plain(mine.jam_us_per_step)} µs"],
        ["27 boats, cycle: time per step", f"{plain(mine.cycle_us_per_step)} µs"],
        ["1000 boats, jam: time per step", f"{plain(large.us_per_step)} µs"],
        ["27 boats, jam: speed against rapier2d-f64", times(mine.jam_faster)],
        ["27 boats, cycle: speed against rapier2d-f64", times(mine.cycle_faster)],
        ["1000 boats, jam: speed against rapier2d-f64", times(large.faster)],
        *_box2d(m),
        [f"27 boats, jam: {less}", times(theirs.jam_overlap_mean_cm / overlap)],
        [f"27 boats, jam: {less}, unit 1 cm", times(tight.jam_overlap_mean_cm / overlap)],
        [
            "less error in sliding for 2 s than rapier2d-f64",
            times(theirs.slide_median_cm / mine.slide_median_cm),
        ],
        [
            "natural residual, worst of all scenes, sizes, schemes and steps",
            f"{plain(own.residual_cm_s.max())} cm/s",
        ],
        ["solves without an exact solution", plain(own.unsolved.sum())],
        *_deepest(settings),
        [f"{most} boats at dt = 0.02 s: speed", f"{times(growth.times_real_time[most])} real time"],
        *_two_threads(growth),
        ["memory in use besides the factor, as a power of n", plain(_power(in_use))],
        [
            "memory held, room for growth included, as a power of n",
            plain(_power(growth.bytes_per_boat)),
        ],
    ]
    return table(["at dt = 0.01 s", "measured"], rows)


def _two_threads(growth: pd.DataFrame) -> list[list[str]]:
    if "two_threads_faster" not in growth:
        return []
    measured = growth.two_threads_faster.dropna()
    return [
        [f"{boats} boats at dt = 0.02 s: speed on two threads against one", times(ratio)]
        for boats, ratio in measured.items()
        if boats in (1000, measured.index.max())
    ]


def _box2d(m: Measurements) -> list[list[str]]:
    rows = []
    for boats in sorted(m.speed[m.speed.scene == "jam"].n.unique()):
        own = pick(m.speed, OURS, scene="jam", n=boats)
        other = pick(m.speed, BOX2D, scene="jam", n=boats)
        ratio = times(other.us_per_step / own.us_per_step)
        rows.append([f"{boats} boats, jam: speed against Box2D", ratio])
    return rows


def _deepest(settings: pd.DataFrame) -> list[list[str]]:
    rows = []
    for relinearizations in range(3):
        row = pick(settings, ours("leapfrog", relinearizations))
        deepest = max(row.jam_overlap_max_cm, row.cycle_overlap_max_cm)
        label = f"deepest overlap, jam and cycle, relinearizations = {relinearizations}"
        rows.append([label, f"{plain(deepest)} cm"])
    return rows


def _power(per_boat: pd.Series) -> float:
    """Return the exponent of the whole in n, over flocks of 100 boats and more if there are any."""
    is_full = per_boat.index.max() > 1000
    chosen = per_boat[per_boat.index >= 100] if is_full else per_boat
    return 1 + np.polyfit(np.log(chosen.index), np.log(chosen), 1)[0]
