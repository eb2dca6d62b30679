"""Leaders at any size: what they add at each size's own critical noise, and how many are needed.

Flocks of 27 to 400 boats in pools of one shape and density. First flocks without leaders find each
size's critical noise; there one leader, or one in 27 boats, steers by the paper's law, the tuned
law or as learned. Written before the runs:

1. Learned leaders beat the tuned law at a size where the interval of the difference of m, paired by
   seed, lies above 0.
2. Larger flocks need a smaller proportion of leaders if m towards the target, with one leader in 27
   boats, grows with the size: the slope of atanh m against log2 n has an interval above 0 for the
   tuned law. It fails where the interval lies below 0.

Written after them: a slope that is open still bounds the change. It is given over the whole range
of sizes, as a share of the mean of atanh m.
"""

import math
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from flockenv.comparison.figure import policy_colors
from studies.claim import Claims, Interval, bca, critical_bw, mean, unknown, write_claims
from studies.picture import COLORS, curve, picture
from studies.section4.fig08 import slope
from studies.study import Options, Row, Study, main, seed_of
from studies.worth.worth_runs import DENSITY_BOATS, LAW, POLICIES
from studies.worth.worth_runs import measure as measure_led

BOATS = (27, 50, 100, 200, 400)
NOISES_S = (0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.8)
FREE_RUNS, RUNS = 16, 64
FIRST = 300  # Seeds that no other study of this folder has.
LED = POLICIES[:3]


def leaders(n_boats: int) -> tuple[int, ...]:
    """Return one leader, and one in 27 boats if that is more."""
    return tuple(sorted({1, round(n_boats / DENSITY_BOATS)}))


def _row(n_boats: int, bw_s: float, k: int, policy: str, seed: int) -> Row:
    row: Row = {"n_boats": n_boats, "bw_s": bw_s, "leaders": k, "policy": policy, "against": 0}
    return row | {"dt_s": 0.05, "minutes": 24.0, "seed": FIRST + seed}


def free() -> list[Row]:
    """Return runs without leaders at every size and noise."""
    return [
        _row(n, bw_s, 0, LAW, seed) for seed in range(FREE_RUNS) for n in BOATS for bw_s in NOISES_S
    ]


def measure_free(row: Row) -> Row:
    """Return Ψ_o and |m| after the first third of a run."""
    scale = math.sqrt(row["n_boats"] / DENSITY_BOATS)
    parameters = flockenv.FlockParameters.preset("simulation").replace(
        n_boats=row["n_boats"],
        bw_s=row["bw_s"],
        dt_s=row["dt_s"],
        pool="wide" if row["n_boats"] == DENSITY_BOATS else (180.0 * scale, 97.0 * scale),
    )
    run = flockenv.simulate(parameters, seed_of(row), 60.0 * row["minutes"], 2.0, dtype=np.float32)
    order = run.analyzed(1 / 3).order
    return {"psi_o": order.psi_o.mean(), "abs_m": abs(order.rotation()).mean()}


FREE = Study("sizes/sizes_free", free, measure_free)


def critical(table: pd.DataFrame) -> dict[int, Interval]:
    """Return the critical noise of each size of which all runs are made."""
    found = {}
    for n, runs in table.groupby("n_boats"):
        groups = [each[["psi_o", "abs_m"]].to_numpy(float) for _, each in runs.groupby("bw_s")]
        if len(runs) == FREE_RUNS * len(NOISES_S):
            found[int(n)] = critical_bw(NOISES_S, groups)
    return found


def led(noises_s: dict[int, float]) -> Study:
    """Return the runs with leaders at these noises."""
    rows = [
        _row(n, noises_s[n], k, policy, seed)
        for seed in range(RUNS)
        for n in BOATS
        if n in noises_s
        for k in leaders(n)
        for policy in LED
    ]
    return Study("sizes/sizes", lambda: rows, measure_led, adaptive=True)


def of(table: pd.DataFrame, n: int, k: int, policy: str) -> pd.Series:
    """Return m of the runs of a policy by seed."""
    same = (table["n_boats"] == n) & (table["leaders"] == k) & (table["policy"] == policy)
    return table[same].set_index("seed")["m"]


def growth(table: pd.DataFrame, policy: str, sizes: list[int]) -> Interval:
    """Return the slope of atanh m against log2 n, with one leader in 27 boats."""
    groups = [of(table, n, leaders(n)[-1], policy).to_numpy()[:, None] for n in sizes]
    if len(groups) < 3:
        return unknown()
    x = [math.log2(n) for n in sizes]
    return bca(groups, lambda *d: slope(x, [np.arctanh(g[..., 0].mean(-1)) for g in d]))


def change(table: pd.DataFrame, policy: str, sizes: list[int]) -> Interval:
    """Return the change of atanh m by that slope from the smallest to the largest size.

    As a share of the mean atanh m.
    """
    groups = [of(table, n, leaders(n)[-1], policy).to_numpy()[:, None] for n in sizes]
    if len(groups) < 3:
        return unknown()
    x = [math.log2(n) for n in sizes]

    def share(*drawn: Any) -> Any:
        means = np.broadcast_arrays(*(each[..., 0].mean(-1) for each in drawn))
        y = np.arctanh(np.stack(means))
        return (x[-1] - x[0]) * slope(x, list(y)) / y.mean(0)

    return bca(groups, share)


def judge(found: dict[int, Interval], table: pd.DataFrame) -> Claims:
    """Judge the two rules."""
    claims = Claims("beyond the paper", "simulation (leapfrog, white), density of wide", ours=True)
    sizes = sorted(int(n) for n in table["n_boats"].unique())
    for n in sizes:
        for k in leaders(n):
            pair = of(table, n, k, "learned") - of(table, n, k, "tuned law")
            claims.add(
                "Learned leaders shift m more than those by the tuned law",
                f"m, learned minus tuned law, paired by seed, k = {k}, bw = {found[n][0]:.2g} s",
                mean(pair.dropna()),
                least=0.0,
                n=str(n),
            )
    for policy in LED:
        claims.add(
            "Larger flocks need a smaller proportion of leaders",
            f"slope of atanh m against log2 n, one leader in 27 boats, {policy}",
            growth(table, policy, sizes),
            least=0.0,
            n=", ".join(map(str, sizes)),
        )
        claims.add(
            "A flock of any size needs about the same proportion of leaders",
            "change of atanh m from the smallest to the largest size by that slope, over its mean, "
            f"{policy}; read as within a quarter",
            change(table, policy, sizes),
            least=-0.25,
            most=0.25,
            n=", ".join(map(str, sizes)),
        )
    return claims


def draw(options: Options, found: dict[int, Interval], table: pd.DataFrame) -> None:
    """Draw the critical noise, and m with one leader and with one in 27, against the size."""
    with picture(options, "sizes", height_cm=7.0) as figure:
        left, middle, right = figure.subplots(1, 3)
        names = ["paper's law" if policy == LAW else policy for policy in LED]
        colors = policy_colors(names)
        curve(left, found, found.values(), color=COLORS[6])
        left.set(ylabel="critical bw (s), no leaders")
        for axes, place, title in ((middle, 0, "one leader"), (right, -1, "one leader in 27")):
            for name, policy in zip(names, LED, strict=True):
                runs = {n: of(table, n, leaders(n)[place], policy) for n in found}
                known = {n: mean(each) for n, each in runs.items() if len(each)}
                if known:
                    curve(axes, known, known.values(), color=colors[name], label=name)
            axes.set(title=title, ylabel="m towards the target")
        for axes in (left, middle, right):
            axes.set(xscale="log", xlabel="number of boats", xticks=BOATS, xticklabels=BOATS)
            axes.minorticks_off()
        handles, labels = middle.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)


def script(options: Options) -> None:
    """Find each size's critical noise, make the runs with leaders there, judge and draw them."""
    found = critical(FREE.results(options))
    known: dict[int, Any] = {n: each for n, each in found.items() if math.isfinite(each[0])}
    if options.trial:
        known = {n: Interval((0.31, 0.3, 0.32), 2) for n in BOATS[:2]}
    if not known:
        return
    table = led({n: round(each[0], 2) for n, each in known.items()}).results(options)
    write_claims(options, "sizes", judge(known, table))
    draw(options, known, table)


if __name__ == "__main__":
    main(script)
