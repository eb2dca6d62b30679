"""Is noise needed for long-term motion? Rotation and jams against bw, and its rise against density.

27 boats of the preset `experiment` first, as the paper has them; then 20 to 50 boats in both pools.
"""

import math

import numpy as np
import pandas as pd
from claim import Claims, Interval, bca, mean, write_claims
from fit import CANDIDATE, constants
from section4 import FREE, READING, STUDY, VERY_LOW_S, over, setup, words
from section5 import READINGS
from starts import RADII_CM
from study import (
    COLORS,
    SEEDS,
    Options,
    Row,
    Study,
    curve,
    flock,
    main,
    order_row,
    picture,
    simulated,
)

BOATS, POOLS = (20, 27, 50), ("wide", "narrow")
FIRST = 100
"""Seeds that no other study of this folder has."""
LEAST_RISE = 0.3
_LOW = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8)
_WIDER = (0.0, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4)
SETS: dict[str, tuple[Row, tuple[float, ...]]] = {
    "simulation": ({"preset": "simulation"}, _LOW),
    "paper": ({"preset": "paper"}, _LOW),
    "experiment": ({"preset": "experiment"}, _WIDER),
    "measured current": ({"preset": "experiment", **constants(CANDIDATE)}, _WIDER),
}
"""Constants and noises up to the one where rotation is at its best, by name."""
_NAMED = sorted({name for row, _ in SETS.values() for name in row} - {"preset"})


def design() -> list[Row]:
    """Return runs of 16 minutes without leaders."""
    rows = []
    for name, (given, noises) in SETS.items():
        known = flock(given).to_dict()
        rows += [
            {"set": name, "preset": given["preset"], **{field: known[field] for field in _NAMED}}
            | {"pool": pool, "n_boats": n, "n_leaders": 0, "bw_s": bw_s}
            | {"minutes": 16.0, "seed": seed}
            for n in BOATS
            for pool in POOLS
            for bw_s in noises
            for seed in range(FIRST, FIRST + SEEDS)
        ]
    return sorted(rows, key=lambda row: row["n_boats"] != 27)


def measure(row: Row) -> Row:
    """Return order and jams of a run."""
    found = order_row(simulated(row, sample_hz=4.0))
    return {name: found[name] for name in ("psi_o", "abs_m", "jammed")}


DENSITY = Study("density", design, measure, lambda row: row["bw_s"] in (0.0, 0.4))


def rise(runs: pd.DataFrame) -> Interval:
    """Return mean |m| at the noise where it is largest minus that without noise."""
    groups = [each[["abs_m"]].to_numpy() for _, each in runs.groupby("bw_s")]

    def of(*drawn: np.ndarray) -> np.ndarray:
        means = np.stack(np.broadcast_arrays(*(each[..., 0].mean(-1) for each in drawn)))
        return np.asarray(means.max(0) - means[0])

    return bca(groups, of)


def covered(pool: str, n_boats: int) -> float:
    """Return the share of the water that hulls cover."""
    p = flock(READINGS["simulation"], pool=pool)
    outer, inner = RADII_CM[pool]
    hull = (math.pi + 4.0 * p.boat_shape) * p.boat_radius_cm**2
    return n_boats * hull / (math.pi * (outer**2 - inner**2))


def judge_density(table: pd.DataFrame) -> Claims:
    """Judge whether noise makes motion, in each pool and number of boats."""
    claims = Claims("6", "")
    for (name, pool, n), runs in table.groupby(["set", "pool", "n_boats"], sort=False):
        claims.reading = f"{name}, {pool}"
        claims.add(
            "Some noise is needed for long-term ordered motion",
            "largest mean |m| of any noise minus that at bw = 0, no leaders; "
            f"read as at least {LEAST_RISE:g}",
            rise(runs),
            least=LEAST_RISE,
            n=f"{n:g}",
        )
    return claims


def draw_density(options: Options, table: pd.DataFrame) -> None:
    """Draw the rise, and |m| without noise, against the share of the water under hulls."""
    with picture(options, "density", height_cm=7.0) as figure:
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        for color, marker, name in zip(COLORS, "osD^", SETS, strict=False):
            cells = {
                100 * covered(pool, n): table[
                    (table["set"] == name) & (table["pool"] == pool) & (table["n_boats"] == n)
                ]
                for pool in POOLS
                for n in BOATS
            }
            cells = {x: runs for x, runs in cells.items() if len(runs)}
            style = {"color": color, "marker": marker, "label": name, "linewidth": 0.6}
            if cells:
                curve(left, cells, [rise(runs) for runs in cells.values()], **style)
                quiet = [runs[runs["bw_s"] == 0.0]["abs_m"].to_numpy() for runs in cells.values()]
                curve(right, cells, [bca([q[:, None]], _mean) for q in quiet], **style)
        left.axhline(LEAST_RISE, color="0.6", linestyle="--", linewidth=0.6)
        left.set(ylabel="rise of mean |m| by noise", ylim=(-0.03, 1.0))
        right.set(ylabel="mean |m| without noise", ylim=(-0.03, 1.0))
        for axes in (left, right):
            axes.set_xlabel("share of the water under hulls (%)\nwide: 4, 5, 9; narrow: 14, 19, 36")
        right.legend()


def _mean(drawn: np.ndarray) -> np.ndarray:
    return np.asarray(drawn[..., 0].mean(-1))


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the summary says of noise."""
    claims = Claims("6, 4.3", READING)
    free = setup(table, FREE)
    none, some = over(free, "abs_m", 0.0, 0.0), over(free, "abs_m", 1.0, 1.0)
    claims.add(
        "Some noise is needed for long-term ordered motion",
        "mean |m| at bw = 1.0 s minus that at bw = 0, no leaders; read as at least 0.3",
        mean(some - none),
        least=0.3,
    )
    claims.add(
        "Jamming dominates at very low noise",
        f"share of jammed frames, {words(VERY_LOW_S)}, no leaders",
        mean(over(free, "jammed", *VERY_LOW_S)),
        least=0.5,
    )
    claims.add(
        "Too much noise turns ordered motion into disordered motion",
        "mean |m| at bw ≥ 2.0 s over that at 1.0 s, no leaders; read as at most a quarter",
        bca(
            [np.stack([over(free, "abs_m", 2.0), some], 1)],
            lambda drawn: drawn[..., 0].mean(-1) / drawn[..., 1].mean(-1),
        ),
        most=0.25,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw |m| and the share of jammed frames against noise."""
    free = setup(table, FREE)
    with picture(options, "noise_makes_motion", width_cm=12.0, height_cm=6.5) as figure:
        axes = figure.subplots()
        shown = (("abs_m", "o", "rotation, mean |m|"), ("jammed", "s", "share of jammed frames"))
        for color, (column, marker, label) in zip(COLORS, shown, strict=False):
            groups = free.groupby("bw_s")[column]
            found = [mean(each) for _, each in groups]
            curve(axes, groups.groups, found, color=color, marker=marker, label=label)
        axes.set(xlabel="backward duration bw (s)", ylim=(-0.03, 1.0))
        axes.set_title(f"27 boats, no leaders, {free['seed'].nunique()} runs of 8 min per level")
        axes.legend()


def script(options: Options) -> None:
    """Make, judge and draw the runs of both studies."""
    table, density = STUDY.results(options), DENSITY.results(options)
    write_claims(options, "noise_makes_motion", [*judge(table), *judge_density(density)])
    draw(options, table)
    if len(density):
        draw_density(options, density)


if __name__ == "__main__":
    main(script)
