"""Is the jamming–order transition of first order? Lifetimes of a jam and of a rotating flock.

The rule of the answer stands in transition.md and was committed before the first run.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from claim import Claim, Interval, bca, proportion, write_claims
from scipy import stats
from study import COLORS, FIRST_SEED, Options, Row, Study, flock, main, picture

from flockenv.runs import initial_flock
from flockenv.statistics import kaplan_meier
from flockenv.statistics.structure import jam_sizes

RUNS = 8
LITERAL_C4 = 0.1 * math.sqrt(0.02)
"""White noise as strong as the literal one of Table 3 at dt = 0.02 s, in rad/s^1.5."""
C4 = (round(LITERAL_C4, 4), 0.1, 0.03, 0.05, 0.02, 0.2)
COVERAGES = (0.5, 0.3, 0.7, 0.2, 1.0)
STARTED = {"one-jam": "in one jam", "rotating": "rotating"}

_EVERY_CYCLES = 5
_HELD = 3
"""Samples in a row that make an exit: one minute."""
_AFTER_MIN = 20.0


def outer_radius_cm(n_boats: int, coverage: float) -> float:
    """Return the radius of the pool on whose outer wall n/coverage boats fit in one row.

    They face outward side by side and touch at their sterns, which are 10 cm from the wall.
    """
    return 10.0 + 5.0 / math.sin(math.pi * coverage / n_boats)


def design() -> list[Row]:
    """Return the map: the literal noise and the extremes of c4 first, small flocks first."""
    literal = {"scheme": "paper", "noise_scheme": "per-step", "dt_s": 0.02}
    white = {"scheme": "leapfrog", "noise_scheme": "white", "dt_s": 0.1}
    first = [(n, 0.5, white | {"c4": c4}) for c4 in C4[:3] for n in (100, 200)]
    second = [(n, 0.5, literal | {"c4": 0.1}) for n in (100, 200)]
    third = [(400, 0.5, white | {"c4": c4}) for c4 in C4[:3]]
    rest = [
        (n, coverage, white | {"c4": c4})
        for n in (100, 200, 400, 800)
        for coverage in COVERAGES
        for c4 in C4
    ]
    finer = [(n, 0.5, white | {"c4": C4[0], "dt_s": 0.02}) for n in (100, 200)]
    cells: list[tuple[int, float, Row]] = []
    for cell in first + second + third + finer + rest:
        if cell not in cells:
            cells.append(cell)
    return [
        {
            **noise,
            "n_boats": n,
            "coverage": coverage,
            "start": start,
            "minutes": 120.0,
            "seed": seed,
        }
        for n, coverage, noise in cells
        for seed in range(RUNS)
        for start in STARTED
    ]


def measure(row: Row) -> Row:
    """Follow a flock without backing until 20 min after it has left its start, or to the end.

    A flock in one jam leaves it when its largest jam has fewer than half of the boats for a minute;
    a rotating one stops when |m|, averaged over a minute, is below 0.4.
    """
    outer = outer_radius_cm(row["n_boats"], row["coverage"])
    parameters = flock(row, bw_s=0.0, pool=(outer, outer * 97.0 / 180.0))
    boats = initial_flock(parameters, FIRST_SEED + row["seed"], row["start"])
    cycle_s = parameters.fw_s + parameters.nop1_s + parameters.nop2_s
    boats.advance(1.5)  # Into the analysis window.
    samples: list[tuple[float, float, float, float, float, float]] = []
    exit_min = math.nan
    while boats.time_s < 60.0 * row["minutes"]:
        order = boats.order_parameters()
        sizes = jam_sizes(parameters, boats.pose[None])[0]
        minutes = boats.time_s / 60.0
        largest = sizes.max(initial=0) / parameters.n_boats
        jams = (sizes.sum() / parameters.n_boats, largest, len(sizes))
        m, outward = order.psi_o * math.sin(order.phi_o), order.psi_o * math.cos(order.phi_o)
        samples.append((minutes, m, outward, *jams))
        last = np.array(samples[-_HELD:])
        if math.isnan(exit_min) and len(last) == _HELD:
            left = (
                (last[:, 4] < 0.5).all()
                if row["start"] == "one-jam"
                else abs(last[:, 1].mean()) < 0.4
            )
            exit_min = last[0, 0] if left else math.nan
        if minutes > exit_min + _AFTER_MIN:
            break
        boats.advance(_EVERY_CYCLES * cycle_s)
    return _summary(np.array(samples), exit_min)


def _summary(samples: np.ndarray, exit_min: float) -> Row:
    minutes = samples[:, 0]
    late = samples[minutes > minutes[-1] - 10.0].mean(axis=0)
    before = samples[~(minutes >= exit_min)]
    steady = before[before[:, 0] > 10.0]
    drift = stats.linregress(steady[:, 0], steady[:, 4]).slope if len(steady) > 10 else math.nan
    return {
        "exited": int(math.isfinite(exit_min)),
        "stayed_min": exit_min if math.isfinite(exit_min) else minutes[-1],
        "m": late[1],
        "outward": late[2],
        "in_jams": late[3],
        "largest": late[4],
        "jams": late[5],
        "largest_before": before[:, 4].mean() if len(before) else math.nan,
        "drift_per_h": 60.0 * drift,
    }


STUDY = Study(
    "transition", design, measure, lambda row: row["coverage"] == 0.5 and row["n_boats"] <= 200
)


def state(row: Mapping[str, Any]) -> str:
    """Return what a flock does in the last ten minutes of its run."""
    if abs(row["m"]) >= 0.5:
        return "rotating"
    if row["largest"] >= 0.5:
        return "one jam"
    return "many jams" if row["in_jams"] >= 0.5 else "neither"


def rate_per_hour(runs: np.ndarray) -> np.ndarray:
    """Return exits per hour in the state: the estimate for lifetimes cut off by the run's end."""
    return np.asarray(60.0 * runs[..., 1].sum(-1) / runs[..., 0].sum(-1))


def cells(table: pd.DataFrame) -> pd.DataFrame:
    """Return one line per noise, coverage, size and start: survivors, rates and states."""
    lines = []
    by = ["scheme", "c4", "dt_s", "coverage", "n_boats", "start"]
    for key, group in table.groupby(by, sort=False):
        pair = group[["stayed_min", "exited"]].to_numpy()
        rate = bca([pair], rate_per_hour)
        states = group.apply(state, axis=1).value_counts()
        lines.append(
            dict(zip(by, key, strict=True))
            | {"runs": len(group), "stay": int((group["exited"] == 0).sum())}
            | {"exits_per_h": rate[0], "low": rate[1], "high": rate[2]}
            | {name: int(states.get(name, 0)) for name in ("rotating", "one jam", "many jams")}
            | {"drift_per_h": group["drift_per_h"].mean(), "minutes": group["stayed_min"].median()}
        )
    return pd.DataFrame(lines)


def doubling(table: pd.DataFrame, start: str) -> Interval:
    """Return by what the rate of exits is multiplied as the flock doubles, largest over smallest.

    A half exit is added to each size, so that sizes without exits have a rate too.
    """
    chosen = table[table["start"] == start]
    sizes = sorted(chosen["n_boats"].unique())
    if len(sizes) < 2:
        return math.nan, math.nan, math.nan
    groups = [
        chosen.loc[chosen["n_boats"] == n, ["stayed_min", "exited"]].to_numpy() for n in sizes
    ]
    x = np.log2(sizes)

    def factor(*runs: np.ndarray) -> np.ndarray:
        rates = [(each[..., 1].sum(-1) + 0.5) / each[..., 0].sum(-1) for each in runs]
        slope = np.tensordot(x - x.mean(), np.log2(rates), 1) / ((x - x.mean()) ** 2).sum()
        return np.asarray(2.0**slope)

    return bca(groups, factor)


def judge(table: pd.DataFrame) -> list[Claim]:
    """Judge the rule of transition.md, at coverage 0.5 and each noise."""
    claims = []
    for (scheme, c4, dt_s), group in table[table["coverage"] == 0.5].groupby(
        ["scheme", "c4", "dt_s"], sort=False
    ):
        sizes = ", ".join(map(str, sorted(group["n_boats"].unique())))
        noise = "per-step" if scheme == "paper" else "white"
        reading = f"{scheme}, {noise} c4 = {c4:g}, dt = {dt_s:g} s, coverage 0.5, n = {sizes}"
        for start in STARTED:
            chosen = group[group["start"] == start]
            stays = proportion((chosen["exited"] == 0).sum(), len(chosen))
            claims.append(
                Claim(
                    f"A flock that starts {STARTED[start]} stays so for two hours",
                    "5.2, left open",
                    reading,
                    "share of runs that stay",
                    stays,
                    len(chosen),
                    least=0.5,
                )
            )
            claims.append(
                Claim(
                    f"The larger a flock that starts {STARTED[start]}, the longer it stays so",
                    "5.2, left open",
                    reading,
                    "factor of exits per hour for each doubling of n",
                    doubling(group, start),
                    len(chosen),
                    most=1.0,
                )
            )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw how many runs are still in the state they started in, by noise and size."""
    shown = table[table["coverage"] == 0.5]
    noises = list(shown.groupby(["scheme", "c4", "dt_s"], sort=False))
    with picture(options, "transition", height_cm=9.0) as figure:
        panels = figure.subplots(2, max(len(noises), 1), sharex=True, sharey=True, squeeze=False)
        for column, ((scheme, c4, dt_s), group) in zip(panels.T, noises, strict=False):
            for axes, start in zip(column, STARTED, strict=True):
                chosen = group[group["start"] == start]
                for color, (n, runs) in zip(COLORS, chosen.groupby("n_boats"), strict=False):
                    times = runs["stayed_min"].where(runs["exited"] == 1, np.inf)
                    left = kaplan_meier(times, runs["stayed_min"])
                    axes.step(
                        [0.0, *left.time_s, runs["stayed_min"].max()],
                        [1.0, *left.share, left.share_at(math.inf)],
                        where="post",
                        color=color,
                        label=f"n = {n} ({len(runs)} runs)",
                    )
                axes.set_ylim(-0.05, 1.05)
            title = "literal" if scheme == "paper" else "white"
            column[0].set_title(f"{title}, c4 = {c4:g}\ndt = {dt_s:g} s")
            column[1].set_xlabel("time (min)")
        panels[0, 0].set_ylabel("still in one jam")
        panels[1, 0].set_ylabel("still rotating")
        panels[0, 0].legend(loc="lower left", fontsize=6)


def script(options: Options) -> None:
    """Make the map, judge and draw it."""
    table = STUDY.results(options)
    write_claims(options, "transition", judge(table))
    if len(table):
        draw(options, table)
        print(cells(table).to_string(float_format="%.3g"))


if __name__ == "__main__":
    main(script)
